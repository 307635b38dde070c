"""Replay of a run's commands, restarted from the measured state at even intervals."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.runs.resample import most_rows
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.parameters import parameters, tank
from swamp_rl.simulator.replay import (
    fixed_thrusters,
    refuse_too_long,
    run_of,
    sample_step,
    start_of,
    velocities_at,
    velocities_of_earth,
)
from swamp_rl.simulator.sensors import observe, true_motion
from swamp_rl.simulator.state import YAW_RATE
from swamp_rl.simulator.step import simulate_in_weather
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.simulator.weather import measured_weather

Array = NDArray[np.float64]

WINDOW = "window"
"""Column of a restarted replay: the number of the window, from 1 on, that a row belongs to."""
GRID_TOLERANCE = 0.3  # of a sample step, how far a row may lie from the grid


@dataclass(frozen=True)
class Restarted:
    """A replay restarted every so often.

    run: in the run format, rows that are lost in the measured run included; each window begins with the
    measured state. miss: (n, 2) position [m] and heading [rad] by which each whole window has missed at its
    end, where the next one starts.
    """

    run: Run
    miss: Array


def replay_restarted(boat: Boat, run: Run, seconds: float, ignore: Sequence[str] = ()) -> Restarted:
    """What `boat` predicts for the run's commands, started anew from the measured state every `seconds`.

    The actuators go on as the commands had them; only the hull is put back. The last window may be shorter.
    Velocities come from the run where it holds all three, else from a parabola through the track about the
    restart. Where rows are lost, the command before stands, and a window starts with the next row that is
    there. Wind and depth that the run measured are inputs, less those in `ignore`. UserError where the run is
    shorter than a window, the window shorter than two samples, a command of this boat is missing, times do
    not lie on a grid, or nearly all rows are lost.
    """
    dt = sample_step(run)
    refuse_too_long(run, boat)
    steps = _steps(run, seconds, dt)
    run.stacked(thruster.command_columns[1] for thruster in boat.thrusters)  # refuses another boat's run
    places = grid_rows(run, dt)
    whole = _held(run, places, dt)
    commands = whole.commands(boat.thruster_names, fixed_thrusters(boat))
    weather = _last_known(measured_weather(whole, boat, ignore))
    nominal = np.arange(0, places[-1], steps)
    rows = np.unique(np.searchsorted(places, nominal))  # of the measured run, that windows start with
    rows = rows[places[rows] < places[-1]]
    params = parameters(boat)
    measured = np.hstack([run.pose[rows], velocities_at(run, rows)])
    of_earth = velocities_of_earth(run)
    motion = true_motion(measured, np.repeat(params, len(rows)), run.time[rows] - run.time[0], of_earth)
    state = start_of(run, boat, params, commands)
    arrived = _arrived(commands, float(params["command_delay"][0]) / dt)
    prompt, curves, substeps = params.copy(), tank(boat), substeps_of(dt, boat)
    prompt["command_delay"] = 0.0
    seeds, tracks = np.zeros(1, np.uint64), []
    limits = [*places[rows].tolist(), int(places[-1])]
    for (first, last), rigid in zip(itertools.pairwise(limits), motion, strict=True):
        state[0, : YAW_RATE + 1] = rigid
        given = arrived[None, first:last]
        felt = weather[None, first:last] if len(weather) else np.zeros((0, 0, 3))
        boats = prompt, curves, state, given, felt, seeds
        tracks.append(simulate_in_weather(*boats, dt, substeps)[0])
        state = tracks[-1][-1:].copy()
    seen = [observe(track[None], params, dt, of_earth=np.array([of_earth]))[0] for track in tracks]
    simulated = run_of(_joined(tracks), _joined(seen), whole.time, whole, boat)
    windows = np.searchsorted(limits[:-1], np.arange(len(whole.time)), side="right")
    simulated.columns[WINDOW] = windows.astype(float)
    ended = len(rows) if limits[-1] - limits[-2] >= steps else len(rows) - 1
    ends = np.array([track[-1, :3] for track in seen[:ended]])
    return Restarted(simulated, _miss(run.pose[np.append(rows, len(run.time) - 1)[1 : ended + 1]], ends))


def grid_rows(run: Run, dt: float) -> NDArray[np.int64]:
    """(T,) place of each row on an even grid of `dt` [s]; UserError for a row that lies between two."""
    place = (run.time - run.time[0]) / dt
    rows = np.rint(place).astype(np.int64)
    wrong = np.abs(place - rows) > GRID_TOLERANCE
    wrong[1:] |= np.diff(rows) <= 0
    if wrong.any():
        row = int(np.argmax(wrong))
        raise UserError(
            f"run {run.name}, row {row + 1}: time {run.time[row]:.6g} s does not fit the sample step of "
            f"{dt:.6g} s; resample the run to a fixed rate (lost rows are fine)"
        )
    return rows


def _held(run: Run, places: NDArray[np.int64], dt: float) -> Run:
    """The run on its whole grid, each lost row as the one before; UserError for more than `most_rows`."""
    most = most_rows(len(run.columns), len(run.time))
    if places[-1] >= most:
        raise UserError(
            f"run {run.name}: {places[-1] + 1} rows with those that are lost, at most {most}; divide the run "
            "where its times jump"
        )
    every = np.arange(places[-1] + 1)
    before = np.searchsorted(places, every, side="right") - 1
    columns = {name: values[before] for name, values in run.columns.items()}
    return Run(run.name, columns | {"time": run.time[0] + dt * every}, run.meta)


def _last_known(weather: Array) -> Array:
    """Weather (T or 0, 3), what is missing in a row as it was last known: a window begins with that."""
    rows = np.arange(len(weather))[:, None]
    place = np.maximum.accumulate(np.where(np.isfinite(weather), rows, 0), axis=0)
    return np.take_along_axis(weather, place, axis=0)


def _arrived(commands: Array, late: float) -> Array:
    """(T, 2K) commands as they act, so many rows late."""
    arrived = np.empty_like(commands)
    for row, own in enumerate(arrived):
        delayed_command(commands, row, late, own)
    return arrived


def _joined(windows: list[Array]) -> Array:
    """Windows one after the other, each without its end, which is where the next begins; the last whole."""
    return np.concatenate([*(window[:-1] for window in windows[:-1]), windows[-1]])


def _steps(run: Run, seconds: float, dt: float) -> int:
    steps = round(seconds / dt) if math.isfinite(seconds) else 0
    if steps < 2:
        raise UserError(f"--window {seconds:g}: must be at least two samples of the run, {2 * dt:g} s")
    if seconds > run.duration + 0.5 * dt:
        raise UserError(
            f"run {run.name}: {run.duration:.6g} s long, too short for windows of {seconds:g} s; "
            "give a shorter --window"
        )
    return steps


def _miss(measured: Array, ends: Array) -> Array:
    apart = ends - measured
    apart[:, 2] = within_half_turn(apart[:, 2])
    return np.stack([np.hypot(apart[:, 0], apart[:, 1]), np.abs(apart[:, 2])], axis=1)
