"""Columns of a run at even times."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.resample import ALWAYS, MOST_CELLS, most_rows, resampled


def test_a_run_is_resampled_to_the_rows_that_it_can_fill() -> None:
    few = {"time": np.array([0.0, 0.1, 1e4]), "north": np.zeros(3)}
    many = {"time": np.linspace(0.0, 1e4, 20_000), "north": np.zeros(20_000)}
    with pytest.raises(UserError, match=f"from 3, at most {ALWAYS}; "):
        resampled(few, 100.0)
    assert len(resampled(few, 1.0)["time"]) == 10_001
    assert len(resampled(many, 100.0)["time"]) == 1_000_001
    assert most_rows(1000, 10**9) == MOST_CELLS // 1000


def test_resampling_turns_the_short_way_and_holds_commands() -> None:
    columns = {
        "time": np.array([0.0, 1.0]),
        "heading": np.array([3.1, -3.1]),
        "joy_angle": np.array([-1.0, 1.0]),
    }
    found = resampled(columns, 4.0)
    assert np.abs(found["heading"]).min() > 3.05
    assert found["joy_angle"].tolist() == [-1.0, -1.0, -1.0, -1.0, 1.0]


def test_a_run_ends_as_its_logged_rows_tell_though_the_last_is_between_those_of_the_grid(
    tmp_path: Path,
) -> None:
    """Midship passes the last gate of camogli, at 22 m north, after the last row of the grid."""
    times = np.append(np.arange(40) * 0.1, 3.95)
    north = np.interp(times, [0.0, 3.92], [0.0, 22.0])
    rows = zip(times, north, np.interp(north, [8.0, 20.0], [0.0, 8.0]), 0.0 * times, strict=True)
    log = tmp_path / "log.csv"
    log.write_text("time,north,east,heading\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    import_runs([log], "csv", tmp_path / "out", About(course="camogli"), Wishes(resample=10.0))
    run = read_dataset(tmp_path / "out").runs[0]
    assert (run.meta.outcome, round(run.duration, 9)) == ("success", 3.9)
