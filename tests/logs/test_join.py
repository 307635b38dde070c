"""Tables joined on one grid: places across the antimeridian, tables that fall silent."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.from_scratch import written
from tests.support.logs import csv_of

TIME = np.round(0.1 * np.arange(300), 1)


def joined(
    folder: Path, tables: dict[str, dict[str, np.ndarray]], mapping: list[str], wishes: Wishes | None = None
) -> Run:
    """The run of tables whose times are their column t, of a boat with two throttles."""
    paths = [
        csv_of(folder / f"{name}.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})
        for name, columns in tables.items()
    ]
    reading, about = (
        Reading(mapping_of(["time=t", *mapping]), "trip"),
        About(boat=str(written(folder, "twin"))),
    )
    import_logs(paths, "csv", folder / "out", about, wishes or Wishes(), reading)
    (run,) = read_dataset(folder / "out").runs
    return run


PLACES = ["latitude=gps.lat", "longitude=gps.lon", "yaw=imu.psi"]


def test_places_are_interpolated_the_short_way_across_the_antimeridian(tmp_path: Path) -> None:
    pytest.importorskip("pyproj")
    east = 179.9995 + 1e-5 * np.arange(100)
    lon = np.where(east > 180.0, east - 360.0, east)
    gps = {"t": 0.2 * np.arange(100), "lat": np.full(100, -17.5), "lon": lon}
    imu = {"t": 0.1 + 0.2 * np.arange(100), "psi": np.full(100, 1.57)}
    run = joined(tmp_path, {"gps": gps, "imu": imu}, PLACES, Wishes(resample=7.0))
    steps = np.diff(run.columns["east"])
    assert steps == pytest.approx(np.full(len(steps), steps.mean()), rel=1e-3)
    assert np.abs(run.columns["longitude"]).max() <= 180.0


def test_longitudes_that_are_no_degrees_are_refused_in_joined_tables_too(tmp_path: Path) -> None:
    pytest.importorskip("pyproj")
    gps = {"t": TIME, "lat": np.full(300, 34.8), "lon": 13530.0 + 1e-3 * TIME}
    imu = {"t": TIME, "psi": np.zeros(300)}
    with pytest.raises(UserError, match="is no longitude in degrees"):
        joined(tmp_path, {"gps": gps, "imu": imu}, PLACES)
