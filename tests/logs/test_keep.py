"""The rows that a mapping keeps: spells in which the boat is armed, afloat or under way."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.logs import csv_of

TIME = np.round(0.1 * np.arange(100), 1)
ARMED = (TIME >= 2.0) & (TIME < 4.0) | (TIME >= 6.0)


def imported(folder: Path, tables: dict[str, dict[str, list[str]]], *mapping: str) -> list[Run]:
    """The runs of tables, joined where there are several, whose times are their column t."""
    paths = [csv_of(folder / f"{name}.csv", columns) for name, columns in tables.items()]
    reading = Reading(mapping_of(["time=t", *mapping]), "trip" if len(paths) > 1 else None)
    import_logs(paths, "csv", folder / "out", About(), Wishes(), reading)
    return list(read_dataset(folder / "out").runs)


def log(**more: list[str]) -> dict[str, list[str]]:
    """A boat that sails north at 1 m/s."""
    times = [f"{t:.1f}" for t in TIME]
    return {"t": times, "x": list(times), "y": ["0"] * 100, "psi": ["0"] * 100, **more}


def test_each_stretch_that_is_kept_is_a_run_and_rows_left_out_may_be_bad(tmp_path: Path) -> None:
    trip = log(mode=[str(int(armed)) for armed in ARMED])
    trip["x"][45] = ""
    runs = imported(tmp_path, {"trip": trip}, "x=x", "y=y", "yaw=psi", "keep=where(mode > 0, 1, 0)")
    assert [(run.name, len(run.time)) for run in runs] == [("trip-1", 20), ("trip-2", 40)]
    assert [run.columns["north"][0] for run in runs] == [2.0, 6.0]
    assert all("keep" not in run.columns for run in runs)
    assert [(run.meta.model_extra or {})["kept"] for run in runs] == [
        "1 of 2: rows 21 to 40 of 100",
        "2 of 2: rows 61 to 100 of 100",
    ]


def test_rows_with_an_infinite_condition_are_not_kept(tmp_path: Path) -> None:
    trip = log(mode=[str(int(not armed)) for armed in ARMED])
    runs = imported(tmp_path, {"trip": trip}, "x=x", "y=y", "yaw=psi", "keep=1 / (1 - mode)")
    assert [(run.name, len(run.time)) for run in runs] == [("trip-1", 20), ("trip-2", 40)]


def test_bad_rows_of_a_stretch_that_is_kept_are_reported_by_their_place_in_the_log(tmp_path: Path) -> None:
    trip = log(mode=[str(int(armed)) for armed in ARMED])
    trip["x"][70] = ""
    with pytest.raises(UserError, match=r"trip\.csv: row 71 \(line 72\), column north: is missing"):
        imported(tmp_path, {"trip": trip}, "x=x", "y=y", "yaw=psi", "keep=mode")


def test_what_is_reported_at_changes_only_keeps_rows_of_another_table(tmp_path: Path) -> None:
    arm = {"t": ["0", "2", "4", "6"], "state": ["0", "1", "0", "1"]}
    runs = imported(
        tmp_path, {"pos": log(), "arm": arm}, "x=pos.x", "y=pos.y", "yaw=pos.psi", "keep=arm.state"
    )
    assert [(run.name, len(run.time)) for run in runs] == [("trip-1", 20), ("trip-2", 40)]


def test_a_mapping_that_keeps_no_row_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="--map keep: is 0 or missing in all rows"):
        imported(tmp_path, {"trip": log()}, "x=x", "y=y", "yaw=psi", "keep=0")
    assert not (tmp_path / "out").exists()
