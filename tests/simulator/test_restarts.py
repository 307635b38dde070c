"""A replay restarted every so often: exact where the boat is right, and clear about what it lacks."""

import json
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.cli.diagnose import simulate_windows

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, read_run, write_run
from swamp_rl.runs.table import write_table
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.restarts import WINDOW, replay_restarted
from tests.support.runs import circling

BOAT = load_boat("swamp")
EFFECTS = [
    {"effect": "azimuth_lag", "time_constant": 0.8},
    {"effect": "command_delay", "delay": 0.35},
    {"effect": "thrust_sag", "rate": 0.01},
    {"effect": "heading_bias", "bias": 0.1},
    {"effect": "position_lever_arm", "x": 0.4, "y": -0.2},
]


@pytest.fixture
def other(tmp_path: Path) -> Boat:
    """SWAMP with slow, late and tiring actuators and with sensors that are off."""
    (tmp_path / "other.yaml").write_text(json.dumps({"extends": "swamp", "effects": EFFECTS}))
    return load_boat(tmp_path / "other.yaml")


def sailed(boat: Boat, seconds: float = 35.0) -> Run:
    """A run of that boat, velocities as they truly were."""
    return replay(boat, Run("sailed", circling(seconds)))


def test_a_boat_that_is_right_never_misses_whatever_its_actuators_and_sensors_do(other: Boat) -> None:
    run = sailed(other)
    found = replay_restarted(other, run, 10.0)
    assert found.miss.shape == (3, 2)
    assert found.miss.max() < 1e-9
    for name in ("north", "east", "surge", "yaw_rate", "applied_azimuth_bs"):
        np.testing.assert_allclose(found.run.columns[name], run.columns[name], atol=1e-9, err_msg=name)


def test_every_window_starts_as_measured_and_the_wrong_boat_misses_more_the_longer_they_are(
    other: Boat,
) -> None:
    run = sailed(other)
    short, long = (replay_restarted(BOAT, run, seconds) for seconds in (2.0, 16.0))
    assert short.miss[:, 0].mean() < 0.3 * long.miss[:, 0].mean()
    first = np.flatnonzero(np.diff(long.run.columns[WINDOW], prepend=0.0))
    assert list(first) == [0, 160, 320]
    np.testing.assert_allclose(long.run.pose[first], run.pose[first], atol=1e-9)
    off = (long.run.pose[first - 1] - run.pose[first - 1])[1:, :2]
    assert np.linalg.norm(off, axis=1).min() > 0.05


def test_velocities_that_were_not_measured_are_read_off_the_track() -> None:
    run = sailed(BOAT)
    bare = {name: values for name, values in run.columns.items() if name not in ("surge", "sway", "yaw_rate")}
    found = replay_restarted(BOAT, Run("bare", bare), 5.0)
    assert found.miss[1:].max() < 0.05


def test_what_the_verb_writes_is_a_run_and_its_line_has_the_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_run(tmp_path / "sailed.csv", sailed(BOAT))
    simulate_windows(tmp_path / "sailed.csv", tmp_path / "again.csv", "swamp", 10.0)
    assert "restarted every 10 s; error at the end of 3 windows" in capsys.readouterr().out
    again = read_run(tmp_path / "again.csv")
    assert {"north", "azimuth_bs", "throttle_sp", WINDOW} <= set(again.columns)
    assert len(again.time) == 351


@pytest.mark.parametrize(
    ("seconds", "message"), [(40.0, "35 s long, too short"), (0.1, "at least two samples")]
)
def test_windows_too_long_or_too_short_are_refused(seconds: float, message: str) -> None:
    with pytest.raises(UserError, match=message):
        replay_restarted(BOAT, sailed(BOAT), seconds)


def test_a_run_without_commands_is_refused_by_the_column_that_is_missing() -> None:
    columns = {name: values for name, values in sailed(BOAT).columns.items() if name != "throttle_ss"}
    with pytest.raises(UserError, match="throttle_ss is missing"):
        replay_restarted(BOAT, Run("bare", columns), 10.0)


def test_rows_that_were_lost_are_sailed_through_and_windows_start_where_there_is_one(
    other: Boat, tmp_path: Path
) -> None:
    steady = {f"{kind}_{name}": 0.3 for kind in ("azimuth", "throttle") for name in other.thruster_names}
    columns = circling(35.0)
    columns |= {name: np.full_like(columns["time"], value) for name, value in steady.items()}
    run = replay(other, Run("sailed", columns))
    kept = np.random.default_rng(1).random(len(run.time)) > 0.1
    kept[95:108] = False  # a stretch about the start of the second window
    kept[[0, -1]] = True
    lossy = Run("lossy", {name: values[kept] for name, values in run.columns.items()})
    found = replay_restarted(other, lossy, 10.0)
    assert len(found.run.time) == len(run.time)
    assert np.flatnonzero(np.diff(found.run.columns[WINDOW]))[0] + 1 == 95 + int(np.argmax(kept[95:]))
    assert found.miss.shape == (3, 2)
    assert found.miss.max() < 1e-9
    write_table(tmp_path / "lossy.csv", lossy.columns)
    simulate_windows(tmp_path / "lossy.csv", tmp_path / "again.csv", "swamp", 10.0)
    assert len(read_run(tmp_path / "again.csv").time) == len(run.time)


def test_times_that_lie_on_no_grid_are_refused_by_row() -> None:
    columns = sailed(BOAT).columns | {}
    columns["time"] = columns["time"].copy()
    columns["time"][17] += 0.05
    with pytest.raises(UserError, match=r"row 18: time 1\.75 s does not fit the sample step of 0\.1 s"):
        replay_restarted(BOAT, Run("uneven", columns), 10.0)


def test_a_run_whose_times_jump_by_days_is_refused_before_its_rows_are_filled_in() -> None:
    columns = sailed(BOAT).columns | {}
    columns["time"] = np.where(np.arange(len(columns["time"])) < 200, columns["time"], columns["time"] + 1e6)
    with pytest.raises(UserError, match=r"1000\d+ rows with those that are lost, .*; divide the run"):
        replay_restarted(BOAT, Run("jumping", columns), 10.0)
