"""Runs cut in pieces, and their split into training and held-out ones."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import Gap, RunSet

PIECE = 120.0  # s of a piece, at least
MOST_PIECES = 16  # of all runs together
FEWEST_RUNS = 3  # with fewer, pieces are held out in place of runs
HELD_OUT_EVERY = 3
LEAST_HELD, MOST_HELD = 0.2, 0.5  # of the time, else the runs are taken in the order of their lengths


@dataclass(frozen=True)
class Split:
    """Pieces that are fitted to and pieces that are held out; by: what was split, `runs`, runs in the order
    of their `lengths`, `pieces` of runs or a `folder` of other runs.
    """

    training: RunSet
    held_out: RunSet
    by: str


def split(run_set: RunSet, other: RunSet | None = None) -> Split:
    """Every third run held out, or every third piece of fewer runs; `other`: runs held out instead.

    Where these are far from a third of the time, as of logs that a gap cuts at like places, it is every third
    run in the order of their lengths.
    """
    if other is not None:
        return Split(pieces(run_set)[0], pieces(other)[0], "folder")
    every, of_run = pieces(run_set)
    by_runs = len(run_set.lengths) >= FEWEST_RUNS
    number = of_run if by_runs else np.arange(len(of_run))
    held = number % HELD_OUT_EVERY == HELD_OUT_EVERY - 1
    by = "runs" if by_runs else "pieces"
    if by_runs and not LEAST_HELD < float(every.lengths[held].sum() / every.lengths.sum()) < MOST_HELD:
        held, by = _by_length(run_set)[of_run], "lengths"
    training, held_out = (every.subset(np.flatnonzero(chosen).tolist()) for chosen in (~held, held))
    return Split(_alone(training), _alone(held_out), by)


def _by_length(run_set: RunSet) -> NDArray[np.bool_]:
    """(R,) every third run from the longest to the shortest."""
    held = np.zeros(len(run_set.lengths), bool)
    held[np.argsort(-run_set.lengths, kind="stable")[HELD_OUT_EVERY - 1 :: HELD_OUT_EVERY]] = True
    return held


def _alone(run_set: RunSet) -> RunSet:
    return replace(run_set, origin=())


def pieces(run_set: RunSet, seconds: float | None = None) -> tuple[RunSet, NDArray[np.int64]]:
    """Every run cut in pieces of about equal length, and the run that each is of.

    seconds: of a piece, at least; by default PIECE, and more in runs that would be of over MOST_PIECES. Of
    fewer runs than FEWEST_RUNS each is cut at least so often that a piece of it is held out.
    """
    total = float(run_set.lengths.sum()) * run_set.dt
    seconds = seconds or max(PIECE, total / MOST_PIECES)
    fewest = HELD_OUT_EVERY if len(run_set.lengths) < FEWEST_RUNS else 1
    rows: list[tuple[int, int, int]] = []
    for run, length in enumerate(run_set.lengths):
        count = max(fewest, int(length * run_set.dt / seconds))
        edges = np.linspace(0, length, count + 1).round().astype(int)
        rows += [(run, int(a), int(b)) for a, b in pairwise(edges)]
    longest = max(b - a for _, a, b in rows)
    commands = np.stack([_rows(run_set.commands[run], a, b, longest, held=True) for run, a, b in rows])
    measured = np.stack([_rows(run_set.measured[run], a, b, longest) for run, a, b in rows])
    weather, ignored = (
        np.stack([_rows(of_runs[run], a, b, longest, held=True) for run, a, b in rows])
        if len(of_runs)
        else of_runs
        for of_runs in (run_set.weather, run_set.ignored)
    )
    gaps = [
        Gap(number, max(gap.row - a, 0), min(gap.row + gap.rows, b) - max(gap.row, a))
        for number, (run, a, b) in enumerate(rows)
        for gap in run_set.gaps
        if gap.run == run and gap.row < b and gap.row + gap.rows > a
    ]
    names = tuple(
        f"{run_set.names[run]}, {a * run_set.dt:.0f} to {b * run_set.dt:.0f} s" for run, a, b in rows
    )
    lengths = np.array([b - a for _, a, b in rows])
    made = replace(
        run_set,
        names=names,
        commands=commands,
        measured=measured,
        lengths=lengths,
        gaps=tuple(gaps),
        weather=weather,
        ignored=ignored,
        origin=(),
        days=(),
        of_earth=tuple(run_set.of_earth[run] for run, _, _ in rows) if run_set.of_earth else (),
    )
    return made, np.array([run for run, _, _ in rows])


def _rows(
    values: NDArray[np.float64], first: int, end: int, count: int, held: bool = False
) -> NDArray[np.float64]:
    """Rows from `first` to `end`, filled up to `count` with the last one where `held`, else with NaN."""
    part = values[first:end]
    filled = np.full((count, values.shape[1]), np.nan)
    filled[: len(part)] = part
    if held:
        filled[len(part) :] = part[-1]
    return filled
