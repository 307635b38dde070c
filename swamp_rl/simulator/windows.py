"""Replay in short windows, each started from the measured state, with the measured wind or none."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.parameters import initial_state, parameters, tank
from swamp_rl.simulator.replay import VELOCITIES, fixed_thrusters, sample_step
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.step import step, substeps_of
from swamp_rl.simulator.weather import MEASURED, measured_weather, set_weather

Array = NDArray[np.float64]

WIND = MEASURED["wind"]


@dataclass(frozen=True)
class Windows:
    """measured, simulated: (n, T + 1, 3) north, east [m], heading [rad, not wrapped] of n windows."""

    measured: Array
    simulated: Array

    @property
    def position_error(self) -> Array:
        """(n, T + 1) distance [m] between the two."""
        apart = self.simulated[..., :2] - self.measured[..., :2]
        return np.hypot(apart[..., 0], apart[..., 1])


def replay_windows(boat: Boat, run: Run, seconds: float, measured_wind: bool = False) -> Windows:
    """Predictions of `boat` for the run's commands, restarted from the measured pose and velocity.

    The windows of `seconds` follow one another without a gap; what is left at the end is not used.
    measured_wind: take wind from the run, row by row, in place of the boat file's. UserError where the run
    is too short or lacks commands, velocities or the wind.
    """
    steps = round(seconds / sample_step(run))
    starts = np.arange(0, len(run.time) - steps, steps) if steps > 0 else np.zeros(0, int)
    if len(starts) == 0:
        raise UserError(f"run {run.name}: {run.duration:.6g} s long, too short for windows of {seconds:g} s")
    return replay_from(boat, run, starts, steps, measured_wind)


def replay_from(
    boat: Boat, run: Run, starts: NDArray[np.int64], steps: int, measured_wind: bool = False
) -> Windows:
    """As `replay_windows`, for windows of `steps` rows that start at the given rows (n,)."""
    dt = sample_step(run)
    rows = starts[:, None] + np.arange(steps + 1)
    pose = run.pose
    pose[:, 2] = np.unwrap(pose[:, 2])
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))[rows]
    if measured_wind:
        run.stacked(WIND)  # refuses a run without
    wind = measured_weather(run, boat)[rows] if measured_wind else None
    params = parameters(boat, len(starts))
    state = initial_state(params, pose[starts], run.stacked(VELOCITIES)[starts])
    state[:, ACTUATORS:] = commands[:, 0]
    seeds = np.zeros(len(starts), np.uint64)
    simulated = np.empty((*rows.shape, 3))
    simulated[:, 0] = state[:, :3]
    for j in range(steps):
        if wind is not None:
            set_weather(params, wind[:, j])
        step(state, params, tank(boat), np.ascontiguousarray(commands[:, j]), seeds, dt, substeps_of(dt))
        simulated[:, j + 1] = state[:, :3]
    return Windows(pose[rows], simulated)
