"""Timing of commands: those that move between two rows, and those that stood in lost rows alone."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.data.run_set import Instants, RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def command_sensitivity(
    problem: Shooting, at: Fit, window: int, changes: Array, within: Array | None = None
) -> Array:
    """(n, M) changes of a window's standardised prediction by changes (n, T, C) of its run's commands, and
    (n, T, parts, C) of those within its rows.
    """
    run_set, win = problem.run_set, problem.windows
    run, count = int(win.run[window]), len(changes)
    unchanged = np.zeros((1, *changes.shape[1:]))
    windows = replace(win.part(np.full(count + 1, window)), run=np.arange(count + 1))
    commands = run_set.commands[run] + np.concatenate([changes, unchanged])
    several = run_set.copies([run] * (count + 1), commands)
    if within is not None:
        before = 0.0 if several.within is None else several.within
        several = replace(several, within=before + np.concatenate([within, 0.0 * within[:1]]))
    weight = np.repeat(problem.weight[run][None], count + 1, axis=0)
    many = Shooting(several, weight, problem.seconds, windows)
    states = np.repeat(at.states[window][None], count + 1, axis=0)
    track = many.track(at.hypothesis, at.x, states)
    return many.part(np.arange(count + 1) < count).standardised(track[:-1] - track[-1]).reshape(count, -1)


def command_changes(run_set: RunSet) -> Array:
    """(R, T, 2K) change of every command until the next row; of azimuths the shorter way round."""
    change = np.diff(run_set.commands, axis=1, append=run_set.commands[:, -1:])
    angles = change[..., : change.shape[2] // 2]
    angles[:] = within_half_turn(angles)
    return change


def interpolated_at(run_set: RunSet, change: Array, shares: Array) -> RunSet:
    """The runs with each command moved by a share (R, T) of its change until the next row: a row that is
    integrated in several steps holds its own command first and takes on the next one at the end, in runs
    whose commands move all the time by a ramp.
    """
    parts = run_set.parts
    within = None
    if parts > 1:
        before = 0.0 if run_set.within is None else run_set.within
        every = zip(change, shares, have_ramps(run_set, change), strict=True)
        moved = [shifted_within(steps, share, parts, ramp) for steps, share, ramp in every]
        within = before + np.array(moved)
        for gap in run_set.gaps:  # whose commands are unknown
            within[gap.run, gap.row : gap.row + gap.rows] = 0.0
    commands = run_set.commands + shares[..., None] * change
    return replace(run_set, commands=commands, within=within, instants=Instants(change, shares))


def have_ramps(run_set: RunSet, change: Array) -> list[bool]:
    """Whether the commands of each run move most of the time, so that they do so within a row too; change:
    (R, T, 2K) from row to row as logged.
    """
    rows = zip(change, run_set.lengths, strict=True)
    return [not are_stepwise(one[: length - 1]) for one, length in rows]


def are_stepwise(change: Array) -> bool:
    """Whether commands are constant most of the time; change: (n, 2K) from row to row."""
    return bool((change == 0.0).all(axis=1).mean() > 0.5)


def shifted_within(change: Array, shares: Array, parts: int, ramp: bool) -> Array:
    """(..., parts, C) commands of the parts of a row less their mean, of rows that take on a share (...) of
    changes (..., C) in the mean: at one instant, or by a ramp as steep as from one row to the next.
    """
    ends = np.arange(parts + 1) / parts
    s = shares[..., None]
    if ramp:
        late, early = np.sqrt(2.0 * np.minimum(s, 0.5)), np.sqrt(2.0 * np.minimum(1.0 - s, 0.5))
        rising = 0.5 * np.maximum(ends - 1.0 + late, 0.0) ** 2
        risen = ends - 0.5 * (early**2 - np.maximum(early - ends, 0.0) ** 2)
        taken = np.where(s < 0.5, rising, risen)  # integral of the share until then
    else:
        taken = np.maximum(ends - 1.0 + s, 0.0)
    of_parts = parts * np.diff(taken, axis=-1)
    return np.asarray((of_parts - s)[..., None] * change[..., None, :])


def with_unlogged_commands(problem: Shooting, at: Fit) -> RunSet | None:
    """The runs of a fit to whole runs with the command change in each run that saves most; None where none is
    significant.

    To first order in the command; the runs' initial states are eliminated.
    """
    commands = problem.run_set.commands.copy()
    found = False
    for window, run in enumerate(problem.windows.run):
        best = _best_change(problem, at, window, int(run))
        if best is not None:
            row, change = best
            commands[run, row] += change
            found = True
    return replace(problem.run_set, commands=commands) if found else None


def _best_change(problem: Shooting, at: Fit, window: int, run: int) -> tuple[int, Array] | None:
    """Row and change (2K,) of the commands there."""
    run_set = problem.run_set
    lost = lost_rows(run_set, run)
    given = run_set.commands[run, : run_set.lengths[run]]
    channels = np.flatnonzero(np.ptp(given, axis=0) > 0)
    if not len(lost) or len(lost) > options().most_lost_rows or not len(channels):
        return None
    slopes = _sensitivity(problem, at, window, lost, channels)
    thrusters = given.shape[1] // 2
    reach = np.where(channels < thrusters, *options().command_reach)
    gains, changes = [], []
    for response in slopes:
        normal = normal_equations(at.states_jacobian[window][None], response[None], at.residual[window][None])
        change = np.linalg.solve(normal.information[0] + np.diag(reach**-2.0), normal.gradient[0])
        gains.append(float(change @ normal.gradient[0]))
        changes.append(change)
    best = int(np.argmax(gains))
    if gains[best] < options().unlogged_gain:
        return None
    whole, most = np.zeros(given.shape[1]), options().unlogged_limit * reach
    whole[channels] = np.clip(changes[best], -most, most)
    return int(lost[best]), whole


def lost_rows(run_set: RunSet, run: int) -> NDArray[np.int64]:
    """Rows of a run without any measurement."""
    return np.flatnonzero(~np.isfinite(run_set.measured[run, : run_set.lengths[run]]).any(axis=1))


def _sensitivity(
    problem: Shooting, at: Fit, window: int, rows: NDArray[np.int64], channels: NDArray[np.int64]
) -> Array:
    """(rows, M, channels) derivative of the standardised prediction of a run by each command in each row."""
    count = len(rows) * len(channels)
    changes = np.zeros((count, *problem.run_set.commands.shape[1:]))
    moved = np.arange(count), np.repeat(rows, len(channels)), np.tile(channels, len(rows))
    changes[moved] = options().command_step
    slopes = command_sensitivity(problem, at, window, changes) / options().command_step
    return np.moveaxis(slopes.reshape(len(rows), len(channels), -1), 1, 2)
