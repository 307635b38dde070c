"""Commands that stood only in lost rows, between two equal logged ones."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, normal_equations
from swamp_rl.criticism.nuisance.command_sensitivity import command_sensitivity
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


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
    reach = np.where(channels < thrusters, options().angle_reach, options().throttle_reach)
    gains, changes = [], []
    for response in slopes:
        normal = normal_equations(at.states_jacobian[window][None], response[None], at.residual[window][None])
        change = np.linalg.solve(normal.information[0] + np.diag(reach**-2.0), normal.gradient[0])
        gains.append(float(change @ normal.gradient[0]))
        changes.append(change)
    best = int(np.argmax(gains))
    if gains[best] < options().unlogged_gain:
        return None
    whole = np.zeros(given.shape[1])
    whole[channels] = np.clip(
        changes[best], -options().unlogged_limit * reach, options().unlogged_limit * reach
    )
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
    changes[np.arange(count), np.repeat(rows, len(channels)), np.tile(channels, len(rows))] = (
        options().command_step
    )
    slopes = command_sensitivity(problem, at, window, changes) / options().command_step
    return np.moveaxis(slopes.reshape(len(rows), len(channels), -1), 1, 2)
