"""Replay the commands of a recorded run through the simulator, from the run's first state."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.parameters import initial_state, parameters, tank
from swamp_rl.simulator.sensors import CHANNELS, observe, true_pose
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.step import simulate, substeps_of

Array = NDArray[np.float64]

VELOCITIES = ("surge", "sway", "yaw_rate")
START_SPAN = 1.0  # s of track that a start velocity is estimated from, where none was measured


def sample_step(run: Run) -> float:
    """The run's time step [s]; UserError for a run too short to have one."""
    if len(run.time) < 2:
        raise UserError(f"run {run.name} has {len(run.time)} row(s); a replay needs two or more")
    return float(np.median(np.diff(run.time)))


def fixed_thrusters(boat: Boat) -> list[str]:
    """Names of the thrusters that do not turn, whose azimuth no run records."""
    return [thruster.name for thruster in boat.thrusters if thruster.kind == "fixed"]


def first_velocity(run: Run) -> Array:
    """(3,) surge, sway [m/s over ground], yaw rate [rad/s] at the start.

    Measured, where the run holds them; otherwise the slope of a parabola through the first second.
    """
    if all(name in run.columns for name in VELOCITIES):
        return run.stacked(VELOCITIES)[0]
    time = run.time - run.time[0]
    near = time <= START_SPAN + 1e-9
    pose = run.pose[near]
    pose[:, 2] = np.unwrap(pose[:, 2])
    degree = min(2, int(near.sum()) - 1)
    north, east, turn = np.polyfit(time[near], pose, degree)[-2]
    cos, sin = math.cos(pose[0, 2]), math.sin(pose[0, 2])
    return np.array([north * cos + east * sin, east * cos - north * sin, turn])


def start_of(run: Run, boat: Boat, params: NDArray[Any], commands: Array) -> Array:
    """(1, S) state at the run's first row; actuators as applied where recorded, else as commanded there."""
    velocity = first_velocity(run)[None]
    state = initial_state(params, true_pose(run.pose[:1], velocity, params), velocity)
    for k, thruster in enumerate(boat.thrusters):
        for column, index in zip(thruster.command_columns, (k, len(boat.thrusters) + k), strict=True):
            applied = run.columns.get(f"applied_{column}")
            state[0, ACTUATORS + index] = commands[0, index] if applied is None else applied[0]
    return state


def run_of(track: Array, measured: Array, time: Array, source: Run, boat: Boat) -> Run:
    """A simulated track (T, S), measured as (T, 6), as a run; commands and levers kept from `source`."""
    columns = {"time": time} | dict(zip(CHANNELS, measured.T, strict=True))
    columns["heading"] = np.pi - np.mod(np.pi - columns["heading"], 2 * np.pi)  # in (-pi, pi]
    kept = ("azimuth_", "throttle_", "rudder_", "propeller_", "joy_")
    columns |= {name: values for name, values in source.columns.items() if name.startswith(kept)}
    for k, thruster in enumerate(boat.thrusters):
        angle, level = thruster.command_columns
        columns[f"applied_{angle or f'azimuth_{thruster.name}'}"] = track[:, ACTUATORS + k]
        columns[f"applied_{level}"] = track[:, ACTUATORS + len(boat.thrusters) + k]
    return Run(source.name, columns)


def replay(boat: Boat, run: Run) -> Run:
    """The track that the boat file predicts for the run's commands, at the run's own times.

    A row's command is held until the next row. UserError where the run holds no commands of this boat.
    """
    dt = sample_step(run)
    run.stacked(thruster.command_columns[1] for thruster in boat.thrusters)  # refuses another boat's run
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    params = parameters(boat)
    start = start_of(run, boat, params, commands)
    seeds = np.zeros(1, np.uint64)
    track = simulate(params, tank(boat), start, commands[None, :-1], seeds, dt, substeps_of(dt))
    return run_of(track[0], observe(track, params, dt)[0], run.time, run, boat)
