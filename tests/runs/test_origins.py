"""Origins of north and east: one for all logs of an import that begin near each other."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from tests.support.logs import csv_of

pytest.importorskip("pyproj")

TIME = 0.1 * np.arange(40)
METRE = 1.0 / 111_132.0
"""Degrees of latitude of about one metre at 45 degrees."""
MAP = ["time=t", "latitude=lat", "longitude=lon", "heading=psi"]


def begins_at(folder: Path, name: str, latitude: float) -> Path:
    """A log of a boat that goes north at 1 m/s."""
    columns = {"t": TIME, "lat": latitude + METRE * TIME, "lon": np.full(40, 9.0), "psi": np.zeros(40)}
    cells = {key: [repr(float(value)) for value in values] for key, values in columns.items()}
    return csv_of(folder / f"{name}.csv", cells)


def imported(folder: Path, *logs: Path, wishes: Wishes | None = None) -> list[Run]:
    reading = Reading(mapping_of(MAP))
    import_logs(logs, "csv", folder / "out", About(), wishes or Wishes(), reading)
    return read_dataset(folder / "out").runs


def test_logs_of_one_import_share_the_first_position_of_the_first_as_origin(tmp_path: Path) -> None:
    first, second = imported(
        tmp_path, begins_at(tmp_path, "a", 45.0), begins_at(tmp_path, "b", 45.0 + 100 * METRE)
    )
    assert first.columns["north"][0] == 0.0
    assert second.columns["north"][0] == pytest.approx(100.0, abs=0.1)
    origin = {"latitude": 45.0, "longitude": 9.0}
    assert [(run.meta.model_extra or {})["origin"] for run in (first, second)] == [origin, origin]


def test_a_log_that_begins_beyond_the_local_plane_has_an_origin_that_later_ones_near_it_share(
    tmp_path: Path,
) -> None:
    starts = {"a": 45.0, "b": 46.0, "c": 46.0 + 100 * METRE, "d": 45.0 - 100 * METRE}
    runs = imported(tmp_path, *(begins_at(tmp_path, name, start) for name, start in starts.items()))
    north = [float(run.columns["north"][0]) for run in runs]
    assert north == pytest.approx([0.0, 0.0, 100.0, -100.0], abs=0.1)


def test_an_origin_that_is_given_holds_for_logs_however_far_apart(tmp_path: Path) -> None:
    paths = [begins_at(tmp_path, name, start) for name, start in (("a", 45.0), ("b", 46.0))]
    first, second = imported(tmp_path, *paths, wishes=Wishes(origin=(45.0, 9.0)))
    assert second.columns["north"][0] - first.columns["north"][0] == pytest.approx(111_132.0, abs=100.0)


def test_runs_imported_about_origins_of_their_own_are_brought_into_one_frame(tmp_path: Path) -> None:
    for name, start in ("a", 45.0), ("b", 45.0 + 100 * METRE):
        (tmp_path / name).mkdir()
        imported(tmp_path / name, begins_at(tmp_path, name, start))
    datasets = [tmp_path / name / "out" for name in ("a", "b")]
    import_runs(datasets, "parquet", tmp_path / "both", None, Wishes(dropped=("north", "east")))
    north = [run.columns["north"][0] for run in read_dataset(tmp_path / "both").runs]
    assert north == pytest.approx([0.0, 100.0], abs=0.1)
