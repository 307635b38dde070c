"""Switching times: the instant between two rows at which each step of the commands happened."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, bounded_step, normal_equations
from swamp_rl.criticism.nuisance.command_sensitivity import command_sensitivity
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

SPREAD = 12.0**-0.5  # standard deviation of a uniform distribution between two rows


def command_changes(run_set: RunSet) -> Array:
    """(R, T, 2K) change of every command until the next row; of azimuths the shorter way round."""
    change = np.diff(run_set.commands, axis=1, append=run_set.commands[:, -1:])
    angles = change[..., : change.shape[2] // 2]
    angles -= 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
    return change


def interpolated_at(run_set: RunSet, change: Array, shares: Array) -> RunSet:
    """The runs with each command moved by a share (R, T) of its change until the next row."""
    return replace(run_set, commands=run_set.commands + shares[..., None] * change)


def fit_shares(
    problem: Shooting, at: Fit, change: Array, shares: Array, common_share: float
) -> tuple[Array, float, int]:
    """(R, T) shares at least chi2 to first order, their weighted mean, and how many were fitted.

    One Gauss-Newton step with a Gaussian prior about `common_share`; the fit's parameters are fixed, the
    initial states are eliminated. `problem` has the commands that `shares` (R, T) gives; change: (R, T, 2K).
    """
    found, fitted, weights = np.full_like(shares, common_share), [], []
    win = problem.windows
    for window in range(win.count):
        run, first = int(win.run[window]), int(win.first[window])
        size = np.abs(change[run, first : first + int(win.steps[window])]).max(axis=1)
        rows = first + np.sort(
            np.argsort(-size, kind="stable")[
                : min(options().most_instants, int((size > options().smallest_change).sum()))
            ]
        )
        if len(rows) == 0:
            continue
        slopes = _sensitivity(problem, at, window, rows, change[run])
        normal = normal_equations(at.states_jacobian[window][None], slopes[None], at.residual[window][None])
        now = shares[run, rows]
        H = normal.information[0] + np.eye(len(rows)) * SPREAD**-2
        g = normal.gradient[0] - (now - common_share) * SPREAD**-2
        found[run, rows] = now + bounded_step(H, g, now, np.zeros(len(rows)), np.ones(len(rows)))
        fitted.append(found[run, rows])
        weights.append(np.clip(1.0 - np.diag(np.linalg.inv(H)) * SPREAD**-2, 1e-6, 1.0))
    if fitted:
        common_share = float(np.average(np.concatenate(fitted), weights=np.concatenate(weights)))
    return found, common_share, sum(map(len, fitted))


def _sensitivity(problem: Shooting, at: Fit, window: int, rows: NDArray[np.int64], change: Array) -> Array:
    """(M, n) derivative of a window's weighted prediction by the shares of n rows."""
    command_changes = np.zeros((len(rows), *change.shape))
    command_changes[np.arange(len(rows)), rows] = options().share_step * change[rows]
    return np.moveaxis(command_sensitivity(problem, at, window, command_changes) / options().share_step, 0, 1)
