"""Predictions in short windows, each from the measured state, with the measured wind or the boat file's."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.runs import Run
from swamp_rl.simulator import initial_state, parameters, tank
from swamp_rl.simulator.replay import VELOCITIES, fixed_thrusters, sample_step
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.step import simulate_in_weather
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.simulator.weather import MEASURED, NO_WEATHER, measured_weather

Array = NDArray[np.float64]

WIND = MEASURED["wind"]


def predicted(boat: Boat, run: Run, starts: NDArray[np.int64], steps: int, measured_wind: bool) -> Array:
    """(n, steps + 1, 3) north, east [m], heading [rad, not wrapped] from the measured state at rows `starts`
    (n,) on, for the run's commands."""
    dt = sample_step(run)
    rows = starts[:, None] + np.arange(steps)
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))[rows]
    weather = measured_weather(run, boat)[rows] if measured_wind else NO_WEATHER[None][:0]
    params = parameters(boat, len(starts))
    state = initial_state(params, run.pose[starts], run.stacked(VELOCITIES)[starts])
    state[:, ACTUATORS:] = commands[:, 0]
    seeds = np.zeros(len(starts), np.uint64)
    return simulate_in_weather(
        params, tank(boat), state, commands, weather, seeds, dt, substeps_of(dt, boat)
    )[..., :3]


def errors_at_end(
    boat: Boat, run: Run, seconds: float, measured_wind: bool, starts: NDArray[np.int64] | None = None
) -> Array:
    """(n,) distance [m] from the measured position at the end of windows of `seconds` that start at rows
    `starts` (n,); without them, of windows that follow one another without a gap."""
    steps = round(seconds / sample_step(run))
    if starts is None:
        starts = np.arange(0, len(run.time) - steps, steps)
    apart = predicted(boat, run, starts, steps, measured_wind)[:, -1, :2] - run.pose[starts + steps, :2]
    return np.hypot(apart[:, 0], apart[:, 1])
