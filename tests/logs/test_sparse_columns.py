"""One table of quantities at several rates, with empty cells between the values of the slower ones."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from tests.support.from_scratch import written
from tests.support.logs import csv_of, weaving

MAP = ["time=t", "x=n", "y=e", "yaw=psi", "throttle_port=port", "throttle_starboard=stb"]
WAS = weaving(rate=15.0)


@pytest.fixture
def boat(tmp_path: Path) -> str:
    return str(written(tmp_path, "twin"))


def log_of(folder: Path, name: str = "log", drop: tuple[int, ...] = ()) -> Path:
    """Rows at 15 Hz with a position in every third and commands at their changes."""
    columns = {"t": WAS["time"], "n": WAS["north"], "e": WAS["east"], "psi": WAS["heading"]}
    columns |= {"port": np.round(WAS["throttle_port"], 1), "stb": np.round(WAS["throttle_starboard"], 1)}
    cells = {key: [repr(float(value)) for value in values] for key, values in columns.items()}
    for i in range(len(WAS["time"])):
        if i % 3:
            cells["n"][i] = cells["e"][i] = ""
    for key in ("port", "stb"):
        same = np.flatnonzero(np.diff(columns[key]) == 0.0) + 1
        cells[key] = ["" if i in same else cell for i, cell in enumerate(cells[key])]
    return csv_of(folder / f"{name}.csv", cells, drop)


def imported(boat: str, *logs: Path, wishes: Wishes | None = None) -> list[Run]:
    out = logs[0].parent / "out"
    import_logs(logs, "csv", out, About(boat=boat), wishes or Wishes(), Reading(mapping_of(MAP)))
    return read_dataset(out).runs


def test_positions_in_every_third_row_are_joined_with_the_rest_as_messages(tmp_path: Path, boat: str) -> None:
    (run,) = imported(boat, log_of(tmp_path))
    assert 1.0 / np.diff(run.time) == pytest.approx(np.full(150, 5.0))
    for name in ("north", "east", "heading"):
        assert run.columns[name] == pytest.approx(WAS[name][::3], abs=2e-3)
    assert run.columns["throttle_port"] == pytest.approx(np.round(WAS["throttle_port"], 1)[::3])
    meta = run.meta.model_extra or {}
    assert "log (x and 1 other) 5 Hz, log (yaw) 15 Hz" in meta["joined"]
    assert "cells_left_out" not in meta


def test_a_table_of_several_rates_is_resampled_to_the_rate_asked_for(tmp_path: Path, boat: str) -> None:
    (run,) = imported(boat, log_of(tmp_path), wishes=Wishes(resample=10.0))
    assert len(run.time) == 301
    assert run.columns["north"] == pytest.approx(np.interp(run.time, WAS["time"], WAS["north"]), abs=2e-2)


def test_rows_of_a_table_of_several_rates_are_counted(tmp_path: Path, boat: str) -> None:
    (run,) = imported(boat, log_of(tmp_path), wishes=Wishes(rate=30.0))
    assert run.duration == pytest.approx(15.0)
    assert "counted, 30 rows a second" in (run.meta.model_extra or {})["times"]


def test_a_gap_in_a_table_of_several_rates_divides_it(tmp_path: Path, boat: str) -> None:
    log = log_of(tmp_path, drop=tuple(range(100, 400)))
    with pytest.raises(UserError, match=r"row \d+, column north: log \(x and 1 other\) has no value for 2\d"):
        imported(boat, log)
    first, second = imported(boat, log, wishes=Wishes(bad_rows="split"))
    assert first.duration == pytest.approx(6.6) and second.duration == pytest.approx(3.2, abs=0.2)


def test_a_column_that_lacks_some_cells_only_keeps_its_rows_and_their_faults(
    tmp_path: Path, boat: str
) -> None:
    columns = {name: [repr(float(x)) for x in WAS[name]] for name in ("time", "north", "east", "heading")}
    columns["north"][100:103] = ["", "", ""]
    log = csv_of(tmp_path / "log.csv", columns)
    reading = Reading(mapping_of([f"{name}={name}" for name in columns]))
    with pytest.raises(UserError, match=r"row 101 \(line 102\), column north: is missing.*3 rows"):
        import_logs([log], "csv", tmp_path / "out", About(boat=boat), Wishes(), reading)


def test_without_a_mapping_the_fault_of_a_slower_column_names_the_option_that_joins_it(
    tmp_path: Path, boat: str
) -> None:
    names = {"time": "t", "north": "n", "east": "e", "heading": "psi"}
    wishes = Wishes(names, dropped=("port", "stb"))
    with pytest.raises(UserError, match=r"column north: is missing.*--map joins columns that come in some"):
        import_runs([log_of(tmp_path)], "csv", tmp_path / "out", About(boat=boat), wishes)
