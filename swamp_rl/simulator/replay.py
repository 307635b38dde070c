"""Replay the commands of a recorded run through the simulator, from the run's first state."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned, wrapped
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.parameters import initial_state, parameters, tank
from swamp_rl.simulator.sensors import CHANNELS, observe, rows_ahead, true_motion
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.step import simulate_in_weather
from swamp_rl.simulator.substeps import longest_substep, substeps_of
from swamp_rl.simulator.weather import measured_weather

Array = NDArray[np.float64]

VELOCITIES = ("surge", "sway", "yaw_rate")
MOST_STEPS = 10**8  # of the simulation of a run: half a minute of a processor, which no signal interrupts
PAUSE = 10.0  # usual steps: the rows that were lost in more cannot be counted
SPAN = 1.0  # s of track to either side of a row that its velocity is estimated from, where none was measured


def sample_step(run: Run) -> float:
    """The run's time step [s], the mean of its steps, lost rows counted and pauses left out; UserError for a
    run too short to have one. The stamps of a log that counts seconds from 1970 are exact to 2e-7 s, and so
    is each step alone.
    """
    if len(run.time) < 2:
        raise UserError(f"run {run.name} has {len(run.time)} row(s); a replay needs two or more")
    steps = np.diff(run.time)
    usual = np.median(steps)
    steps = steps[steps < PAUSE * usual]
    return float(steps.sum() / np.rint(steps / usual).sum())


def refuse_too_long(run: Run, boat: Boat) -> None:
    """UserError for a run of more than `MOST_STEPS`, such as one whose times are in another unit."""
    seconds = float(run.time[-1] - run.time[0])
    if seconds > MOST_STEPS * longest_substep(boat):
        raise UserError(
            f"run {run.name} lasts {seconds:.3g} s, longer than a replay may; look at the unit of its times, "
            "or divide it"
        )


def fixed_thrusters(boat: Boat) -> list[str]:
    """Names of the thrusters that do not turn, whose azimuth no run records."""
    return [thruster.name for thruster in boat.thrusters if thruster.kind == "fixed"]


def unused_columns(boat: Boat, run: Run) -> list[str]:
    """Columns of the run that command the azimuth of a thruster that does not turn; a replay ignores them."""
    return [name for name in (f"azimuth_{fixed}" for fixed in fixed_thrusters(boat)) if name in run.columns]


def velocities_at(run: Run, rows: Sequence[int] | NDArray[np.int64]) -> Array:
    """(n, 3) surge, sway [m/s over ground], yaw rate [rad/s] at those rows (n,).

    Measured, where the run holds them; otherwise the slope of a parabola through the rows within SPAN, of a
    line where these are two. The nearest other row always counts.
    """
    if all(name in run.columns for name in VELOCITIES):
        return run.stacked(VELOCITIES)[rows]
    pose = run.pose
    pose[:, 2] = np.unwrap(pose[:, 2])
    found = np.empty((len(rows), 3))
    for i, row in enumerate(rows):
        time = run.time - run.time[row]
        near = np.abs(time) <= max(SPAN, np.partition(np.abs(time), 1)[1]) + 1e-9
        north, east, turn = np.polyfit(time[near], pose[near], min(2, int(near.sum()) - 1))[-2]
        found[i] = *turned(north, east, -pose[row, 2]), turn
    return found


def velocities_of_earth(run: Run) -> bool:
    """Whether a run's surge and sway were turned by its heading: at import, or in `velocities_at`."""
    return run.meta.velocity_axes == "earth" or not all(name in run.columns for name in VELOCITIES)


def start_of(run: Run, boat: Boat, params: NDArray[Any], commands: Array) -> Array:
    """(1, S) state at the run's first row; actuators as applied where recorded, else as commanded there."""
    measured = np.hstack([run.pose[:1], velocities_at(run, [0])])
    motion = true_motion(measured, params, of_earth=velocities_of_earth(run))
    state = initial_state(params, motion[:, :3], motion[:, 3:])
    for k, thruster in enumerate(boat.thrusters):
        for column, index in zip(thruster.command_columns, (k, len(boat.thrusters) + k), strict=True):
            applied = run.columns.get(f"applied_{column}")
            state[0, ACTUATORS + index] = commands[0, index] if applied is None else applied[0]
    return state


def run_of(track: Array, measured: Array, time: Array, source: Run, boat: Boat) -> Run:
    """A simulated track (T, S), measured as (T, 6), as a run; commands and levers kept from `source`."""
    columns = {"time": time} | dict(zip(CHANNELS, measured.T, strict=True))
    columns["heading"] = wrapped(columns["heading"])
    kept = ("azimuth_", "throttle_", "rudder_", "propeller_", "joy_", "wind_", "depth")
    columns |= {name: values for name, values in source.columns.items() if name.startswith(kept)}
    for k, thruster in enumerate(boat.thrusters):
        angle, level = thruster.command_columns
        if angle is not None:
            columns[f"applied_{angle}"] = track[:, ACTUATORS + k]
        columns[f"applied_{level}"] = track[:, ACTUATORS + len(boat.thrusters) + k]
    return Run(source.name, columns)


def replay(boat: Boat, run: Run, ignore: Sequence[str] = ()) -> Run:
    """The track that the boat file predicts for the run's commands, at the run's own times.

    A row's command is held until the next row, and so are the wind and the depth where the run measured them;
    `ignore`: those of `swamp_rl.simulator.weather.MEASURED` that are left out. UserError where the run holds
    no commands of this boat.
    """
    dt = sample_step(run)
    refuse_too_long(run, boat)
    run.stacked(thruster.command_columns[1] for thruster in boat.thrusters)  # refuses another boat's run
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    params = parameters(boat)
    start = start_of(run, boat, params, commands)
    seeds = np.zeros(1, np.uint64)
    ahead = rows_ahead(params, (len(run.time) - 1) * dt, dt)
    held = held_on(commands, ahead)[:-1]
    weather = measured_weather(run, boat, ignore)
    felt = held_on(weather, ahead)[None, :-1] if len(weather) else np.zeros((0, 0, 3))
    track = simulate_in_weather(params, tank(boat), start, held[None], felt, seeds, dt, substeps_of(dt, boat))
    rows = slice(len(run.time))
    seen = observe(track, params, dt, of_earth=np.array([velocities_of_earth(run)]))[0, rows]
    return run_of(track[0, rows], seen, run.time, run, boat)


def held_on(rows: Array, more: int) -> Array:
    """(T + more, n) the rows (T, n), the last one repeated."""
    return np.concatenate([rows, np.repeat(rows[-1:], more, axis=0)])
