"""Commands that changed while no row was written: which reading of them the boat obeyed."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Gap, Trials
from swamp_rl.criticism.fit import Fit, normal_equations, settle
from swamp_rl.criticism.shooting import Shooting, Windows, window_data

Array = NDArray[np.float64]

AROUND = 5.0  # s to either side of a gap that two readings are compared over
HARMLESS = 2.0  # chi2 between the earliest and the latest change that no fit needs to bother with
CLEARLY = 1.0  # chi2 by which the other reading of a lost row must be better
ELSEWHERE, UNLIKELY = (
    (0.5, -1.0, 2.0),
    9.0,
)  # shares of the change, and the chi2 that such a reading must save
LONGEST = 5  # rows beyond which the commands of a gap are not guessed
ROUNDS = 5  # steps that a reading's initial state is given


def without_harmless(trials: Trials, weight: Array) -> Trials:
    """The same trials, doubtful only where it makes a difference which command stood while rows were lost."""
    short = [gap for gap in trials.gaps if gap.rows <= LONGEST]
    kept = [gap for gap in trials.gaps if gap.rows > LONGEST]
    if short:
        problem, _ = _readings(trials, weight, short, ends_alone=True)
        states = np.repeat(problem.guess()[::2], 2, axis=0)
        tracks = problem.predict(Hypothesis(), np.zeros((1, 0)), states[None])[0]
        apart = problem.part(np.arange(len(tracks)) % 2 == 0).weighed(tracks[1::2] - tracks[::2])
        power = (apart**2).sum(axis=1)
        kept += [gap for gap, much in zip(short, power, strict=True) if much > HARMLESS]
    return replace(trials, gaps=tuple(kept))


def resolved(trials: Trials, weight: Array, every: Sequence[Gap], hypothesis: Hypothesis, x: Array) -> Trials:
    """The trials with each short gap of `every` read as fits best under a hypothesis at x (p,)."""
    short = [gap for gap in every if gap.rows <= LONGEST and stepwise(trials, gap.run)]
    if not short:
        return trials
    commands = trials.commands.copy()
    problem, group = _readings(trials, weight, short)
    _, _, residual = settle(problem, hypothesis, x, problem.guess(), ROUNDS)
    loss = (residual**2).sum(axis=1)
    loss += [needed for gap in short for _, needed in choices(trials, gap)]
    for number, gap in enumerate(short):
        mine = np.flatnonzero(group == number)
        best = problem.trials.commands[mine[loss[mine].argmin()]]
        rows = slice(gap.row, gap.row + gap.rows)
        commands[gap.run, rows] = best[rows]
    kept = tuple(gap for gap in trials.gaps if gap not in short)
    return replace(trials, commands=commands, gaps=kept)


def stepwise(trials: Trials, run: int) -> bool:
    """Whether a run's commands stand still most of the time; those that always move are drawn straight over a
    gap.
    """
    commands = trials.commands[run, : trials.lengths[run]]
    return bool((commands[1:] == commands[:-1]).all(axis=1).mean() > 0.5)


def choices(trials: Trials, gap: Gap) -> list[tuple[Array, float]]:
    """Commands (rows, 2K) that may have stood in a gap, and the chi2 that each must save: the change came
    after so many rows of it; or another command stood there, half way or as far to either side, for a moment.
    """
    commands = trials.commands[gap.run]
    before, after = commands[gap.row - 1], commands[gap.row + gap.rows]
    late = np.arange(gap.rows)[:, None]
    found = [(np.where(late < keeps, before, after), 0.0) for keeps in range(gap.rows, -1, -1)]
    for share in ELSEWHERE:
        held = before + share * (after - before)
        held[len(held) // 2 :] = np.clip(held[len(held) // 2 :], -1.0, 1.0)
        found.append((np.repeat(held[None], gap.rows, axis=0), UNLIKELY))
    return found


def reread(problem: Shooting, at: Fit, every: Sequence[Gap]) -> Trials:
    """The trials of a fit to whole runs, lost rows read the other way where that fits clearly better."""
    trials = problem.trials
    commands = trials.commands.copy()
    for gap in every:
        window = np.flatnonzero(problem.windows.run == gap.run)
        if gap.rows > LONGEST or len(window) != 1 or not stepwise(trials, gap.run):
            continue
        one = problem.part(problem.windows.run == gap.run)
        rows = slice(gap.row, gap.row + gap.rows)
        losses = []
        readings = [(commands[gap.run, rows].copy(), 0.0), *choices(trials, gap)]
        for reading, needed in readings:
            changed = trials.commands.copy()
            changed[gap.run, rows] = reading
            one = one.under(replace(trials, commands=changed))
            track = one.predict(at.hypothesis, at.x[None], at.states[window][None])[0]
            none = np.zeros((1, track.size, 0))
            normal = normal_equations(at.states_jacobian[window], none, one.residuals(track))
            losses.append(needed + float(normal.free.sum()))
        best = int(np.argmin(losses))
        if losses[best] < losses[0] - CLEARLY:
            commands[gap.run, rows] = readings[best][0]
    return replace(trials, commands=commands)


def _readings(
    trials: Trials, weight: Array, gaps: Sequence[Gap], ends_alone: bool = False
) -> tuple[Shooting, NDArray[np.int64]]:
    """A window about each gap for each reading of its commands, as runs of their own, and (W,) whose gap's.

    ends_alone: only the latest and the earliest change.
    """
    every = [choices(trials, gap) for gap in gaps]
    rows = [
        (number, reading)
        for number, found in enumerate(every)
        for reading, _ in ((found[0], found[gaps[number].rows]) if ends_alone else found)
    ]
    group = np.array([number for number, _ in rows])
    runs = np.array([gaps[number].run for number in group])
    commands = trials.commands[runs]
    around = math.ceil(AROUND / trials.dt)
    first = np.array([max(0, gaps[number].row - around) for number in group])
    last = np.array([gaps[number].row + gaps[number].rows + around for number in group])
    for i, (number, reading) in enumerate(rows):
        gap = gaps[number]
        commands[i, gap.row : gap.row + gap.rows] = reading
    lengths = trials.lengths[runs]
    several = replace(
        trials,
        names=trials.names[:1] * len(rows),
        commands=commands,
        measured=trials.measured[runs],
        lengths=lengths,
        gaps=(),
    )
    steps = np.minimum(lengths - 1, last) - first
    own = np.arange(len(rows))
    measured, seen = window_data(several, weight[runs], own, first, steps, 0)
    windows = Windows(own, first, steps, measured, seen, 0, int(steps.max()) + 1)
    return Shooting(several, weight[runs], AROUND, windows), group
