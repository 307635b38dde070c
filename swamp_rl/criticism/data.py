"""Measured runs as arrays on one uniform grid, gaps marked, ready to be compared with rollouts."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.refusals import (
    SHORTEST,
    refuse_disorder,
    refuse_other_boat,
    refuse_too_coarse,
    refuse_too_short,
    refuse_unexciting,
)
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, inspect_dataset
from swamp_rl.simulator.replay import fixed_thrusters, sample_step

Array = NDArray[np.float64]

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")
UNITS = ("m", "m", "rad", "m/s", "m/s", "rad/s")
GRID_TOLERANCE = 0.3  # of a sample step, how far a row may lie from the grid


@dataclass(frozen=True)
class Gap:
    """Rows lost while the command changed: `rows` of them from `row` on in a run. What was commanded there is
    not known.
    """

    run: int
    row: int
    rows: int


@dataclass(frozen=True)
class Trials:
    """R runs of up to T samples of one boat.

    dt: sample step [s]; commands: (R, T, 2K), straight between the neighbours where a row is missing;
    measured: (R, T, 6) in the order of CHANNELS (SI, rad, heading unwrapped), NaN where there is none;
    lengths: (R,) samples of each run; gaps: where the commands are doubtful; slow: (6, 2) standard deviation
    [the channel's unit] and time constant [s] of errors that wander, where there are such; too_short: runs
    that are left out.
    """

    boat: Boat
    dt: float
    names: tuple[str, ...]
    commands: Array
    measured: Array
    lengths: NDArray[np.int64]
    gaps: tuple[Gap, ...] = ()
    slow: Array | None = None
    too_short: tuple[str, ...] = ()

    @property
    def present(self) -> tuple[str, ...]:
        """Channels that some run holds."""
        here = np.isfinite(self.measured).any(axis=(0, 1))
        return tuple(CHANNELS[channel] for channel in np.flatnonzero(here))

    def subset(self, runs: list[int]) -> "Trials":
        """The trials of those runs alone."""
        return Trials(
            self.boat,
            self.dt,
            tuple(self.names[run] for run in runs),
            self.commands[runs],
            self.measured[runs],
            self.lengths[runs],
            tuple(Gap(runs.index(gap.run), gap.row, gap.rows) for gap in self.gaps if gap.run in runs),
            self.slow,
        )


def read_trials(folder: Path | str, boat: Boat, named: str | Path | None = None) -> Trials:
    """A folder of measured runs on a uniform grid.

    named: the boat's name or file, for a plain folder without a `dataset.yaml` to say it. Rows may be
    missing: gaps are marked, nothing is filled in. UserError for any other fault of the folder, and where
    there is too little to compare, saying what is missing.
    """
    folder = Path(folder)
    found = inspect_dataset(folder, named)
    faults = [fault for fault in found.faults if fault.column != "time"]
    if faults:
        raise UserError(f"{folder}{os.sep}{faults[0]}")
    return trials_of(found.runs, boat, str(folder))


def trials_of(every: list[Run], boat: Boat, folder: str) -> Trials:
    """Runs on a uniform grid; `folder` begins every message. UserError."""
    for run in every:
        refuse_disorder(run, folder)
    refuse_too_short(every, folder)
    runs = [run for run in every if run.duration >= SHORTEST]
    for run in runs:
        refuse_other_boat(run, boat, folder)
    dt = float(np.median([sample_step(run) for run in runs]))
    refuse_too_coarse(dt, folder)
    placed = [_on_grid(run, boat, dt, folder) for run in runs]
    longest = max(len(commands) for commands, _, _ in placed)
    commands = np.zeros((len(runs), longest, placed[0][0].shape[1]))
    measured = np.full((len(runs), longest, len(CHANNELS)), np.nan)
    for index, (command, track, _) in enumerate(placed):
        commands[index, : len(command)] = command
        commands[index, len(command) :] = command[-1]
        measured[index, : len(track)] = track
    lengths = np.array([len(track) for _, track, _ in placed])
    gaps = tuple(Gap(index, *lost) for index, (_, _, every) in enumerate(placed) for lost in every)
    names = tuple(run.name for run in runs)
    short = tuple(run.name for run in every if run.duration < SHORTEST)
    trials = Trials(boat, dt, names, commands, measured, lengths, gaps, too_short=short)
    refuse_unexciting(
        [command for command, _, _ in placed], [track[:, :3] for _, track, _ in placed], dt, folder
    )
    return trials


def _on_grid(run: Run, boat: Boat, dt: float, folder: str) -> tuple[Array, Array, list[tuple[int, int]]]:
    place = (run.time - run.time[0]) / dt
    index = np.rint(place).astype(int)
    off = np.abs(place - index)
    if off.max() > GRID_TOLERANCE or (np.diff(index) <= 0).any():
        row = int(off.argmax()) + 1
        raise UserError(
            f"{folder}: run {run.name}, row {row}: time {run.time[row - 1]:.3f} s does not fit the sample "
            f"step of {dt:.4f} s; resample the run to a fixed rate (missing rows are fine)"
        )
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    track = np.full((index[-1] + 1, len(CHANNELS)), np.nan)
    for column, name in enumerate(CHANNELS):
        if name in run.columns:
            values = run.columns[name]
            track[index, column] = np.unwrap(values) if name == "heading" else values
    filled, lost = _filled(index, commands)
    return filled, track, lost


def _filled(index: NDArray[np.int64], commands: Array) -> tuple[Array, list[tuple[int, int]]]:
    """Commands (T, 2K) of every row, from those of the rows that are there, and (row, rows) of each gap over
    which they changed. An angle that goes more than a quarter round jumps, and is not drawn straight.
    """
    rows = np.arange(index[-1] + 1)
    last = np.searchsorted(index, rows, side="right") - 1
    next_ = np.minimum(last + 1, len(index) - 1)
    share = (rows - index[last]) / np.maximum(index[next_] - index[last], 1)
    change = commands[next_] - commands[last]
    jumps = np.abs(change) > np.pi / 2
    filled = commands[last] + np.where(jumps, 0.0, change * share[:, None])
    lost = np.flatnonzero((np.diff(index) > 1) & (np.abs(np.diff(commands, axis=0)) > 1e-9).any(axis=1))
    return filled, [(int(index[i]) + 1, int(index[i + 1] - index[i]) - 1) for i in lost]
