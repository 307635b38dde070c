"""Commands during lost rows: the sequence that fits the measurement best."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.data.run_set import Gap, RunSet
from swamp_rl.criticism.data.windows import Windows, window_data
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, fit_states
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.command_timing import are_stepwise
from swamp_rl.criticism.options import options
from swamp_rl.simulator.substeps import steps_over

Array = NDArray[np.float64]
Reading = tuple[tuple[Gap, Array], ...]  # (rows, 2K) commands in gaps of one run


def with_relevant_gaps(run_set: RunSet, weight: Array) -> RunSet:
    """The runs with those gaps only in which the unknown command matters to the prediction."""
    short = [gap for gap in run_set.gaps if gap.rows <= options().longest_gap]
    if not short:
        return run_set
    latest_and_earliest = [
        ((gap, readings[place][0]),)
        for gap in short
        for readings in [possible_commands(run_set, gap)]
        for place in (0, gap.rows)
    ]
    problem = _windows_of_each(run_set, weight, latest_and_earliest)
    states = np.repeat(problem.initial_states()[::2], 2, axis=0)
    tracks = problem.predict(Hypothesis(), np.zeros((1, 0)), states[None])[0]
    apart = problem.part(np.arange(len(tracks)) % 2 == 0).standardised(tracks[1::2] - tracks[::2])
    matters = (apart**2).sum(axis=1) > options().negligible_gap
    ignored = {gap for gap, kept in zip(short, matters, strict=True) if not kept}
    return replace(run_set, gaps=tuple(gap for gap in run_set.gaps if gap not in ignored))


def with_best_commands(
    run_set: RunSet, weight: Array, every: Sequence[Gap], hypothesis: Hypothesis, x: Array
) -> RunSet:
    """The runs with the best-fitting commands in each short gap of `every`, under a hypothesis at x (p,)."""
    short = [gap for gap in every if gap.rows <= options().longest_gap and has_instant(run_set, gap)]
    if not short:
        return run_set
    kept = tuple(gap for gap in run_set.gaps if gap not in short)
    short = [gap for gap in short if changes_in(run_set, gap)]
    if not short:
        return run_set if kept == run_set.gaps else replace(run_set, gaps=kept)
    commands = run_set.commands.copy()
    for groups in _in_one_window(run_set, short):
        readings, needed, ends = list[Reading](), list[float](), [0]
        for group in groups:
            for one in product(*(possible_commands(run_set, gap) for gap in group)):
                readings.append(tuple((gap, given) for gap, (given, _) in zip(group, one, strict=True)))
                needed.append(sum(gain for _, gain in one))
            ends.append(len(readings))
        problem = _windows_of_each(replace(run_set, commands=commands), weight, readings)
        _, _, residual = fit_states(problem, hypothesis, x, problem.initial_states(), options().gap_rounds)
        loss = (residual**2).sum(axis=1) + needed
        for begin, end in pairwise(ends):
            for gap, given in readings[begin + int(loss[begin:end].argmin())]:
                commands[gap.run, gap.row : gap.row + gap.rows] = given
    return replace(run_set, commands=commands, gaps=kept, filled=tuple(short))


def _in_one_window(run_set: RunSet, gaps: Sequence[Gap]) -> list[list[tuple[Gap, ...]]]:
    """The gaps, two of them together where the window of one holds the other: apart, each would make up for
    what the other one has wrong. Then the pairs across these groups, each to be judged beside the commands
    found before.
    """
    groups = list[tuple[Gap, ...]]()
    around = steps_over(options().around_gap, run_set.dt)

    def near(one: Gap, other: Gap) -> bool:
        return one.run == other.run and other.row - one.row <= around

    for gap in sorted(gaps, key=lambda one: (one.run, one.row)):
        if groups and len(groups[-1]) == 1 and near(groups[-1][0], gap):
            groups[-1] = (*groups[-1], gap)
        else:
            groups.append((gap,))
    across: list[tuple[Gap, ...]] = [
        (one[-1], other[0]) for one, other in pairwise(groups) if near(one[-1], other[0])
    ]
    return [groups, across] if across else [groups]


def has_instant(run_set: RunSet, gap: Gap) -> bool:
    """Whether commands change over a gap at an instant: those that are constant most of the time, and one
    that changes by far more than in the rows beside the gap. Others move all the time and are interpolated.
    """
    commands = run_set.commands[gap.run, : run_set.lengths[gap.run]]
    if are_stepwise(np.diff(commands, axis=0)):
        return True
    rows = np.array([gap.row - 2, gap.row - 1, gap.row + gap.rows, gap.row + gap.rows + 1])
    change = np.diff(commands[np.clip(rows, 0, len(commands) - 1)], axis=0)
    thrusters = change.shape[1] // 2
    change[:, :thrusters] = within_half_turn(change[:, :thrusters])
    before, over, after = np.abs(change)
    ramp = (gap.rows + 1) * np.maximum(before, after)
    return bool((over > np.maximum(options().smallest_change, options().jump_ratio * ramp)).any())


def changes_in(run_set: RunSet, gap: Gap) -> bool:
    """Whether the command after a gap is another than before it; else no instant is unknown."""
    commands = run_set.commands[gap.run]
    return bool((commands[gap.row - 1] != commands[gap.row + gap.rows]).any())


def possible_commands(run_set: RunSet, gap: Gap) -> list[tuple[Array, float]]:
    """Commands (rows, 2K) that are possible in a gap, and the chi2 that each must save: the change after any
    number of its rows, or another command during the gap, half way or as far to either side.
    """
    commands = run_set.commands[gap.run]
    before, after = commands[gap.row - 1], commands[gap.row + gap.rows]
    late = np.arange(gap.rows)[:, None]
    found = [(np.where(late < keeps, before, after), 0.0) for keeps in range(gap.rows, -1, -1)]
    change, thrusters = after - before, len(after) // 2
    change[:thrusters] = within_half_turn(change[:thrusters])
    for share in options().other_shares:
        held = before + share * change
        held[thrusters:] = np.clip(held[thrusters:], -1.0, 1.0)
        found.append((np.repeat(held[None], gap.rows, axis=0), options().other_share_gain))
    return found


def with_commands_refined(problem: Shooting, at: Fit, every: Sequence[Gap]) -> RunSet:
    """The runs of a fit to whole runs, commands in gaps exchanged where others fit better by
    `other_command_gain`. One gap after the other, each beside what was exchanged before: apart, two gaps
    would both make up for the same error.
    """
    run_set = problem.run_set
    commands = run_set.commands.copy()
    for gap in every:
        window = np.flatnonzero(problem.windows.run == gap.run)
        unknown = gap.rows <= options().longest_gap and changes_in(run_set, gap)
        if not unknown or len(window) != 1 or not has_instant(run_set, gap):
            continue
        one = problem.part(problem.windows.run == gap.run)
        rows = slice(gap.row, gap.row + gap.rows)
        losses = []
        readings = [(commands[gap.run, rows].copy(), 0.0), *possible_commands(run_set, gap)]
        for reading, needed in readings:
            changed = commands.copy()
            changed[gap.run, rows] = reading
            one = one.with_commands(replace(run_set, commands=changed))
            track = one.track(at.hypothesis, at.x, at.states[window])
            none = np.zeros((1, track.size, 0))
            normal = normal_equations(at.states_jacobian[window], none, one.residuals(track))
            losses.append(needed + float(normal.profile_chi2.sum()))
        best = int(np.argmin(losses))
        if losses[best] < losses[0] - options().other_command_gain:
            commands[gap.run, rows] = readings[best][0]
    return replace(run_set, commands=commands)


def _windows_of_each(run_set: RunSet, weight: Array, readings: Sequence[Reading]) -> Shooting:
    """A window for each reading, about its gaps."""
    own = np.arange(len(readings))
    runs = [reading[0][0].run for reading in readings]
    commands = run_set.commands[runs]
    for given, reading in zip(commands, readings, strict=True):
        for gap, one in reading:
            given[gap.row : gap.row + gap.rows] = one
    around = steps_over(options().around_gap, run_set.dt)
    first = np.maximum(0, [reading[0][0].row - around for reading in readings])
    end = np.array([reading[-1][0].row + reading[-1][0].rows + around for reading in readings])
    several = run_set.copies(runs, commands)
    steps = np.minimum(run_set.lengths[runs] - 1, end) - first
    measured, seen = window_data(several, weight[runs], own, first, steps, 0)
    windows = Windows(own, first, steps, measured, seen, 0, int(steps.max()) + 1)
    return Shooting(several, weight[runs], options().around_gap, windows)
