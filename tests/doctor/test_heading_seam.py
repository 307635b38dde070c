"""A heading that was interpolated from 359 to 1 degree through 180."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.angles import turned, wrapped
from swamp_rl.boat import Boat
from swamp_rl.doctor.examine import examine
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.schema import DatasetMeta
from tests.support.doctored import Columns
from tests.support.from_scratch import written

EVERY = 5  # rows between two samples of the compass


def interpolated(c: Columns, seam: float) -> Columns:
    """The run in a frame in which the heading crosses the seam of its compass half-way, with the compass
    sampled at EVERY rows and interpolated as a number of degrees above the seam."""
    by = seam - np.unwrap(c["heading"])[300]
    north, east = turned(c["north"], c["east"], np.full(601, by))
    compass = np.degrees(np.unwrap(c["heading"]) + by - seam) % 360.0
    logged = np.interp(c["time"], c["time"][::EVERY], compass[::EVERY])
    return c | {"north": north, "east": east, "heading": wrapped(np.radians(logged) + seam)}


@pytest.mark.parametrize("seam", [0.0, np.pi])
def test_a_heading_interpolated_across_its_seam_is_named_and_left_out_of_the_other_checks(
    seam: float, sound: list[Run], twin: Boat
) -> None:
    runs = [Run(run.name, interpolated(dict(run.columns), seam)) for run in sound]
    found = {one.code: one for one in examine(runs, twin)}
    assert found["heading_seam"].runs == tuple(run.name for run in runs)
    assert "heading_unrelated" not in found
    rates = [Run(run.name, run.columns | {"yaw_rate": np.degrees(run.columns["yaw_rate"])}) for run in runs]
    units = [one.columns for one in examine(rates, twin) if one.code == "unit"]
    assert units == [("yaw_rate",)]


def test_the_advice_on_a_heading_interpolated_across_its_seam_mends_it(
    sound: list[Run], twin: Boat, tmp_path: Path
) -> None:
    about = {"mass": twin.mass, "draught": twin.draught, "water_density": twin.water_density}
    name = str(written(tmp_path, "twin"))
    create_dataset(tmp_path / "runs", DatasetMeta(vehicle=name, sample_rate=10.0, source="measured", **about))
    for run in sound:
        append_run(tmp_path / "runs", Run(run.name, interpolated(dict(run.columns), 0.0)))
    runs = read_dataset(tmp_path / "runs").runs
    (result,) = [one for one in examine(runs, twin) if one.code == "heading_seam"]
    reading = Reading(mapping_of([result.advice.split("'")[1]]))
    wishes = Wishes(resample=10.0, bad_rows="split", fill=3.0)
    import_logs([tmp_path / "runs"], "parquet", tmp_path / "mended", About(boat=name), wishes, reading)
    mended = read_dataset(tmp_path / "mended").runs
    assert len(mended) == len(sound)
    assert "heading_seam" not in [one.code for one in examine(mended, twin)]
