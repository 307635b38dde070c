"""Commands that stood only while a row was lost: between two equal rows a lever may have been tapped."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, normal_equations
from swamp_rl.criticism.responses import command_responses
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

STEP = 0.1  # rad or of full throttle, of the finite difference
REACH_OF_ANGLE, REACH_OF_THROTTLE = 1.5, 0.5  # rad, 1: standard deviation of a tap beforehand
WORTH = 40.0  # chi2 that a tap must save to be believed: a run has tens of lost rows to choose from
MOST_ROWS = 60  # lost rows of a run beyond which none is looked at


def tapped(problem: Shooting, at: Fit) -> Trials | None:
    """The trials of a fit to whole runs with the tap in each run that would save most; None if none would.

    A command in a lost row is taken to act linearly; the runs' initial states follow it.
    """
    commands = problem.trials.commands.copy()
    found = False
    for window, run in enumerate(problem.windows.run):
        best = _best_tap(problem, at, window, int(run))
        if best is not None:
            row, change = best
            commands[run, row] += change
            found = True
    return replace(problem.trials, commands=commands) if found else None


def _best_tap(problem: Shooting, at: Fit, window: int, run: int) -> tuple[int, Array] | None:
    """Row and change (2K,) of the commands there."""
    trials = problem.trials
    lost = lost_rows(trials, run)
    given = trials.commands[run, : trials.lengths[run]]
    channels = np.flatnonzero(np.ptp(given, axis=0) > 0)
    if not len(lost) or len(lost) > MOST_ROWS or not len(channels):
        return None
    slopes = _responses(problem, at, window, lost, channels)
    thrusters = given.shape[1] // 2
    reach = np.where(channels < thrusters, REACH_OF_ANGLE, REACH_OF_THROTTLE)
    gains, changes = [], []
    for response in slopes:
        normal = normal_equations(at.states_jacobian[window][None], response[None], at.residual[window][None])
        change = np.linalg.solve(normal.information[0] + np.diag(reach**-2.0), normal.gradient[0])
        gains.append(float(change @ normal.gradient[0]))
        changes.append(change)
    best = int(np.argmax(gains))
    if gains[best] < WORTH:
        return None
    whole = np.zeros(given.shape[1])
    whole[channels] = np.clip(changes[best], -2.0 * reach, 2.0 * reach)
    return int(lost[best]), whole


def lost_rows(trials: Trials, run: int) -> NDArray[np.int64]:
    """Rows of a run that hold no measurement at all."""
    return np.flatnonzero(~np.isfinite(trials.measured[run, : trials.lengths[run]]).any(axis=1))


def _responses(
    problem: Shooting, at: Fit, window: int, rows: NDArray[np.int64], channels: NDArray[np.int64]
) -> Array:
    """(rows, M, channels) change of the weighted prediction of a run by each command in each of its rows."""
    count = len(rows) * len(channels)
    changes = np.zeros((count, *problem.trials.commands.shape[1:]))
    changes[np.arange(count), np.repeat(rows, len(channels)), np.tile(channels, len(rows))] = STEP
    slopes = command_responses(problem, at, window, changes) / STEP
    return np.moveaxis(slopes.reshape(len(rows), len(channels), -1), 1, 2)
