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


TIME = np.arange(0.0, 300.0, 0.1)


def seams(heading: np.ndarray, **others: np.ndarray) -> list[float]:
    """Places at which a heading (T,) [rad] at TIME is found to be interpolated across its seam."""
    still = np.zeros(len(TIME))
    columns = {"time": TIME, "north": still, "east": still, "heading": np.asarray(wrapped(heading))}
    found = examine([Run("one", columns | others)])
    return [one.figures["places"] for one in found if one.code == "heading_seam"]


def test_a_course_that_weaves_over_north_is_interpolated_wherever_it_crosses() -> None:
    samples = np.where(TIME < 270.0, 1.5 + 0.4 * np.sin(0.05 * TIME), 0.0)[::10]
    samples[-10:] = np.radians(np.tile([2.0, -2.0], 5))
    logged = np.interp(TIME, TIME[::10], samples % (2.0 * np.pi))
    assert seams(logged) == [9.0]


@pytest.mark.parametrize("off", [0.8, np.pi])
def test_one_row_of_a_heading_near_north_that_is_off_is_no_seam(off: float) -> None:
    heading = 0.05 * np.sin(0.1 * TIME)
    heading[1000] += off
    assert seams(heading) == []


def test_the_advice_leaves_out_the_rows_at_the_seam_beside_a_row_that_is_off() -> None:
    samples = np.where(TIME < 270.0, 1.5 + 0.4 * np.sin(0.05 * TIME), 0.0)[::10]
    samples[-10:] = np.radians(np.tile([2.0, -2.0], 5))
    logged = np.interp(TIME, TIME[::10], samples % (2.0 * np.pi))
    logged[1000] += 2.0
    still = np.zeros(len(TIME))
    run = Run("one", {"time": TIME, "north": still, "east": still, "heading": np.asarray(wrapped(logged))})
    (found,) = [one for one in examine([run]) if one.code == "heading_seam"]
    limit = float(found.advice.partition("> ")[2].partition(",")[0])
    crossing = np.radians(356.0)  # rad/s: samples are 1 s apart
    assert 0.5 * crossing < limit < crossing


def test_parts_of_a_run_with_a_seam_in_each_are_one_run_in_the_report() -> None:
    samples = np.where(TIME < 270.0, 1.5 + 0.4 * np.sin(0.05 * TIME), 0.0)[::10]
    samples[[100, -1]] = np.radians(-2.0)
    samples[99] = samples[101] = samples[-2] = np.radians(2.0)
    north = np.where(TIME < 150.0, 0.0, 500.0) + TIME
    logged = np.asarray(wrapped(np.interp(TIME, TIME[::10], samples % (2.0 * np.pi))))
    columns = {"time": TIME, "north": north, "east": 0.0 * TIME, "heading": logged}
    (found,) = [one for one in examine([Run("one", columns)]) if one.code == "heading_seam"]
    assert found.as_json()["runs"] == ["one"] and "heading (one):" in str(found)
    assert len(found.runs) == 2


def test_a_full_turn_from_north_to_north_is_no_seam_where_the_yaw_rate_shows_it() -> None:
    turn = 2.0 * np.pi * np.clip((TIME - 150.0) / 6.0, 0.0, 1.0)
    heading = turn + 0.0005 * np.sin(3.0 * TIME)
    rate = np.gradient(heading, TIME)
    assert seams(heading, yaw_rate=rate) == seams(heading, yaw_rate=np.degrees(rate)) == []
    assert seams(heading, yaw_rate=rate - np.gradient(turn, TIME)) == [1.0]
