"""The instant of each step of the commands between two rows: beside what was found, each where it fits."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, bounded_step, normal_equations
from swamp_rl.criticism.responses import command_responses
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

STEP = 0.25  # share of a step by which its instant is moved to see what that does
SPREAD = 12.0**-0.5  # standard deviation of an instant that may be anywhere between two rows
MOST = 60  # steps of a window whose instants are told, the largest; levers that always move need none
SMALL = 0.02  # rad or of full throttle: steps that are left where they are


def changes(trials: Trials) -> Array:
    """(R, T, 2K) what every command changes by until the next row; azimuths the short way round."""
    change = np.diff(trials.commands, axis=1, append=trials.commands[:, -1:])
    angles = change[..., : change.shape[2] // 2]
    angles -= 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
    return change


def read_at(trials: Trials, change: Array, shares: Array) -> Trials:
    """The trials with each command moved by a share (R, T) of its change until the next row."""
    return replace(trials, commands=trials.commands + shares[..., None] * change)


def best_shares(
    problem: Shooting, at: Fit, change: Array, shares: Array, usual: float
) -> tuple[Array, float, int]:
    """(R, T) shares at their best beside a fit to the same windows, to first order, what they usually are,
    and how many were told; the fit's numbers stay, the windows' initial states follow. `problem` has the
    commands as `shares` read them; usual: the share of a step that tells nothing of its own.
    """
    found, told, weights = np.full_like(shares, usual), [], []
    win = problem.windows
    for window in range(win.count):
        run, first = int(win.run[window]), int(win.first[window])
        size = np.abs(change[run, first : first + int(win.steps[window])]).max(axis=1)
        rows = first + np.sort(np.argsort(-size, kind="stable")[: min(MOST, int((size > SMALL).sum()))])
        if len(rows) == 0:
            continue
        slopes = _responses(problem, at, window, rows, change[run])
        normal = normal_equations(at.states_jacobian[window][None], slopes[None], at.residual[window][None])
        now = shares[run, rows]
        H = normal.information[0] + np.eye(len(rows)) * SPREAD**-2
        g = normal.gradient[0] - (now - usual) * SPREAD**-2
        found[run, rows] = now + bounded_step(H, g, now, np.zeros(len(rows)), np.ones(len(rows)))
        told.append(found[run, rows])
        weights.append(np.clip(1.0 - np.diag(np.linalg.inv(H)) * SPREAD**-2, 1e-6, 1.0))
    if told:
        usual = float(np.average(np.concatenate(told), weights=np.concatenate(weights)))
    return found, usual, sum(map(len, told))


def _responses(problem: Shooting, at: Fit, window: int, rows: NDArray[np.int64], change: Array) -> Array:
    """(M, n) slopes of a window's weighted prediction by the share of the change after each of n rows."""
    changes = np.zeros((len(rows), *change.shape))
    changes[np.arange(len(rows)), rows] = STEP * change[rows]
    return np.moveaxis(command_responses(problem, at, window, changes) / STEP, 0, 1)
