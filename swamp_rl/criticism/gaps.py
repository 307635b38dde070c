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
        apart = (tracks[1::2] - tracks[::2]) * problem.windows.weight[::2]
        power = (apart**2).sum(axis=(1, 2))
        kept += [gap for gap, much in zip(short, power, strict=True) if much > HARMLESS]
    return replace(trials, gaps=tuple(kept))


def resolved(trials: Trials, weight: Array, every: Sequence[Gap], hypothesis: Hypothesis, x: Array) -> Trials:
    """The trials with each short gap of `every` read as fits best under a hypothesis at x (p,): the command
    changed before, after or between the lost rows.
    """
    short = [gap for gap in every if gap.rows <= LONGEST and steps_over(trials, gap)]
    if not short:
        return trials
    commands = trials.commands.copy()
    problem, group = _readings(trials, weight, short)
    _, _, residual = settle(problem, hypothesis, x, problem.guess(), ROUNDS)
    loss = (residual**2).sum(axis=1)
    for number, gap in enumerate(short):
        mine = np.flatnonzero(group == number)
        best = problem.trials.commands[mine[loss[mine].argmin()]]
        rows = slice(gap.row, gap.row + gap.rows)
        commands[gap.run, rows] = best[rows]
    kept = tuple(gap for gap in trials.gaps if gap not in short)
    return replace(trials, commands=commands, gaps=kept)


def steps_over(trials: Trials, gap: Gap) -> bool:
    """Whether the command stood still before and after the gap; one that always moves is drawn straight."""
    commands = trials.commands[gap.run]
    after = gap.row + gap.rows
    before = np.array_equal(commands[max(gap.row - 2, 0)], commands[gap.row - 1])
    return before and np.array_equal(commands[after], commands[min(after + 1, len(commands) - 1)])


def reread(problem: Shooting, at: Fit, every: Sequence[Gap]) -> Trials:
    """The trials of a fit to whole runs, lost rows read the other way where that fits clearly better."""
    trials = problem.trials
    commands = trials.commands.copy()
    for gap in every:
        window = np.flatnonzero(problem.windows.run == gap.run)
        if gap.rows != 1 or len(window) != 1 or not steps_over(trials, gap):
            continue
        one = problem.part(problem.windows.run == gap.run)
        row = commands[gap.run, gap.row].copy()
        ends = (commands[gap.run, gap.row - 1], commands[gap.run, gap.row + 1])
        other = ends[int(np.array_equal(row, ends[0]))]
        loss = []
        for reading in (row, other):
            changed = trials.commands.copy()
            changed[gap.run, gap.row] = reading
            one.trials = replace(trials, commands=changed)
            del one.plain_actuators
            track = one.predict(at.hypothesis, at.x[None], at.states[window][None])[0]
            slopes = np.zeros((1, track.size, 0))
            loss.append(normal_equations(at.states_jacobian[window], slopes, one.residuals(track)).free.sum())
        if loss[1] < loss[0] - CLEARLY:
            commands[gap.run, gap.row] = other
    return replace(trials, commands=commands)


def _readings(
    trials: Trials, weight: Array, gaps: Sequence[Gap], ends_alone: bool = False
) -> tuple[Shooting, NDArray[np.int64]]:
    """A window about each gap for each reading of its commands, as runs of their own, and (W,) whose gap's.

    ends_alone: only the latest and the earliest change.
    """
    rows = [
        (number, keeps)
        for number, gap in enumerate(gaps)
        for keeps in ((gap.rows, 0) if ends_alone else range(gap.rows + 1))
    ]
    group = np.array([number for number, _ in rows])
    runs = np.array([gaps[number].run for number in group])
    commands = trials.commands[runs]
    around = math.ceil(AROUND / trials.dt)
    first = np.array([max(0, gaps[number].row - around) for number in group])
    last = np.array([gaps[number].row + gaps[number].rows + around for number in group])
    for i, (number, keeps) in enumerate(rows):
        gap = gaps[number]
        commands[i, gap.row : gap.row + keeps] = trials.commands[gap.run, gap.row - 1]
        commands[i, gap.row + keeps : gap.row + gap.rows] = trials.commands[gap.run, gap.row + gap.rows]
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
