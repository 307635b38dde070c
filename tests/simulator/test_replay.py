"""Replaying a run's commands gives back a run that the simulator made, and says what it cannot replay."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay, run_of, sample_step, unused_columns, velocities_at
from swamp_rl.simulator.restarts import replay_restarted
from swamp_rl.simulator.state import HEADING
from swamp_rl.simulator.substeps import substeps_of
from tests.support.boats import Array, commands, track

BOAT = load_boat("swamp")


def turning_commands() -> Array:
    return np.concatenate([commands(40, -20, (0.9, 0.8, 0.3, 0), 100), commands(-70, 0, (1, 1, 0, 0), 200)])


def recorded() -> Run:
    command = turning_commands()
    start = {"pose": (1.0, 2.0, 3.0), "velocity": (0.5, -0.1, 0.2)}
    states = track(BOAT, command[:-1], **start, substeps=substeps_of(0.1, BOAT))
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in BOAT.thruster_names]
    columns = dict(zip(names, command.T, strict=True))
    return run_of(states, states[:, :6], 0.1 * np.arange(len(states)), Run("turn", columns), BOAT)


def test_a_simulated_run_is_replayed_to_the_rounding_of_its_wrapped_heading() -> None:
    run = recorded()
    again = replay(BOAT, run)
    for name in ("north", "east", "surge", "sway", "yaw_rate", "applied_azimuth_bs"):
        assert np.allclose(again.columns[name], run.columns[name], rtol=0, atol=1e-9), name


@pytest.mark.parametrize("of", [replay, lambda boat, run: replay_restarted(boat, run, 10.0)])
@pytest.mark.parametrize("unit", [1e9, 1e300])
def test_a_run_whose_times_are_in_another_unit_is_refused(
    of: Callable[[Boat, Run], Any], unit: float
) -> None:
    run = recorded()
    run.columns["time"] = unit * run.time
    with pytest.raises(UserError, match="unit of its times"):
        of(BOAT, run)


def test_a_log_that_counts_seconds_from_1970_is_sampled_and_integrated_as_any_other() -> None:
    times = 1_764_000_000.123 + 0.1 * np.arange(300)  # which a float holds to 2e-7 s
    step = sample_step(Run("log", {"time": times}))
    assert abs(step - 0.1) < 1e-8
    assert substeps_of(step, BOAT) == substeps_of(0.1, BOAT) == 1


def test_the_sample_step_of_a_log_with_lost_rows_and_uneven_stamps_is_that_of_its_clock() -> None:
    rng = np.random.default_rng(3)
    rows = np.flatnonzero(rng.uniform(size=600) > 0.1)
    times = 0.0997 * (rows + rng.uniform(-0.2, 0.2, len(rows)))
    assert abs(sample_step(Run("log", {"time": times})) / 0.0997 - 1.0) < 2e-3


def test_headings_are_written_between_minus_pi_and_pi() -> None:
    heading = recorded().columns["heading"]
    assert np.all(heading > -np.pi) and np.all(heading <= np.pi)
    turn = np.zeros((3, 17))
    turn[:, HEADING] = [np.pi, -np.pi, 3 * np.pi + 0.1]
    written = run_of(turn, turn[:, :6], np.arange(3.0), Run("turn", {}), BOAT).columns["heading"]
    assert np.allclose(written, [np.pi, np.pi, -np.pi + 0.1])


def test_a_start_velocity_that_was_not_measured_is_read_off_the_track() -> None:
    run = recorded()
    bare = {name: values for name, values in run.columns.items() if name not in ("surge", "sway", "yaw_rate")}
    estimated = velocities_at(Run("turn", bare), [0])
    assert estimated[0] == pytest.approx([0.5, -0.1, 0.2], abs=0.02)


def test_a_run_with_rows_seconds_apart_has_the_velocity_between_its_rows() -> None:
    time = np.arange(0.0, 20.0, 2.0)
    still = {f"{kind}_{name}": 0.0 * time for kind in ("azimuth", "throttle") for name in BOAT.thruster_names}
    run = Run("slow", {"time": time, "north": 0.5 * time, "east": 0.0 * time, "heading": 0.0 * time} | still)
    assert velocities_at(run, [0, 4, 9]) == pytest.approx(np.tile([0.5, 0.0, 0.0], (3, 1)))
    assert replay(BOAT, run).columns["surge"][0] == pytest.approx(0.5)


def test_a_run_without_the_boats_commands_is_refused_by_name() -> None:
    run = recorded()
    columns = {name: values for name, values in run.columns.items() if name != "throttle_ss"}
    with pytest.raises(UserError, match="throttle_ss"):
        replay(BOAT, Run("turn", columns))


def test_a_run_of_one_row_is_refused() -> None:
    run = recorded()
    with pytest.raises(UserError, match="two or more"):
        replay(BOAT, Run("turn", {name: values[:1] for name, values in run.columns.items()}))


def test_a_replay_with_sensor_effects_starts_where_the_measurements_do(tmp_path: Path) -> None:
    effects = [
        {"effect": "heading_bias", "bias": 0.1},
        {"effect": "position_delay", "delay": 0.5},
        {"effect": "position_lever_arm", "x": 0.4, "y": 0.1},
    ]
    (tmp_path / "off.yaml").write_text(json.dumps({"extends": "swamp", "effects": effects}))
    run = recorded()
    again = replay(load_boat(tmp_path / "off.yaml"), run)
    for name in ("north", "east", "heading", "surge"):
        assert again.columns[name][0] == pytest.approx(run.columns[name][0], abs=1e-9), name
    assert abs(again.columns["north"][50] - run.columns["north"][50]) > 0.05


def test_the_azimuths_of_a_thruster_that_does_not_turn_are_named_as_unused() -> None:
    fixed = {"kind": "fixed", "azimuth_min": 0.0, "azimuth_max": 0.0, "azimuth_rate": None}
    boat = load_boat("swamp", {"thruster_model": {**fixed, "azimuth_time_constant": None}})
    assert unused_columns(boat, recorded()) == [f"azimuth_{name}" for name in BOAT.thruster_names]
    assert unused_columns(BOAT, recorded()) == []
