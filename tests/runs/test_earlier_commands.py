"""Import of runs whose commands were stamped after the motion that they cause."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.errors import UserError
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.earlier_commands import with_earlier_commands
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.resample import is_held
from swamp_rl.runs.table import read_table


def numbered(rows: int = 50, rate: float = 10.0) -> Run:
    """A run whose commands and positions are the numbers of their rows."""
    count = np.arange(float(rows))
    columns = dict.fromkeys(("north", "throttle_port", "joy_thrust"), count)
    return Run("one", {"time": 7.0 + count / rate, **columns})


@given(st.integers(-40, 40))
def test_each_row_has_the_command_of_so_many_rows_later(shift: int) -> None:
    found = with_earlier_commands(numbered(), shift / 10.0).columns
    assert len(found["time"]) == 50 - abs(shift)
    assert np.array_equal(found["throttle_port"], found["north"] + shift)
    assert np.array_equal(found["joy_thrust"], found["north"] + shift)
    assert found["time"] == pytest.approx(7.0 + found["north"] / 10.0)


def test_commands_are_held_between_rows() -> None:
    found = with_earlier_commands(numbered(), 0.25)
    assert np.array_equal(found.columns["throttle_port"], found.columns["north"] + 2.0)
    assert "0.25 s earlier; 3 rows after the last command" in str(found.meta.model_extra)


@pytest.mark.parametrize("seconds", [4.9, -4.9, 1e300])
def test_a_shift_as_long_as_the_run_is_refused(seconds: float) -> None:
    with pytest.raises(UserError, match=r"run one: lasts 4.9 s, .* give fewer seconds"):
        with_earlier_commands(numbered(), seconds)


def test_a_run_without_commands_is_refused() -> None:
    with pytest.raises(UserError, match="it has no commands"):
        with_earlier_commands(Run("one", {"time": np.arange(5.0), "north": np.zeros(5)}), 1.0)


def test_a_dataset_of_ours_is_imported_with_earlier_commands(folder: Path, tmp_path: Path) -> None:
    (folder / "two.parquet").rename(tmp_path / "two.parquet")
    there = read_table(folder / "one.csv").columns
    import_runs([folder / "one.csv"], "csv", tmp_path / "out", None, Wishes(earlier=0.5))
    found = read_dataset(tmp_path / "out").runs[0]
    kept = len(found.time)
    shift = len(there["time"]) - kept
    assert shift == round(0.5 / (there["time"][1] - there["time"][0]))
    for name, values in there.items():
        moved = values[shift:] if is_held(name) else values[:kept]
        assert np.array_equal(found.columns[name], moved), name
