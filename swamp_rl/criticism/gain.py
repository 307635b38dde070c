"""Prediction error by horizon, before and after, on runs that the numbers were not fitted to."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import CHANNELS, Trials
from swamp_rl.criticism.shooting import SETTLING, Shooting, Windows, wrap
from swamp_rl.sensors import true_pose

Array = NDArray[np.float64]

HORIZONS = (1.0, 5.0, 10.0, 30.0)  # s
RESTART = 5.0  # s between restarts, where the horizon is not longer
RESAMPLES = 2000


@dataclass(frozen=True)
class Change:
    """Root mean square errors before and after, and the 95 % interval of before less after, paired."""

    before: float
    after: float
    ci95: tuple[float, float]


def errors_at(trials: Trials, weight: Array, horizon: float, hypothesis: Hypothesis, x: Array) -> Array:
    """(n, 6) measured less predicted at the end of `horizon` [s], restarted from smoothed measured states.

    x: (R, p), each run's own numbers. NaN where nothing was measured.
    """
    found = []
    for run in range(len(trials.lengths)):
        one = trials.subset([run])
        windows = _restarts(one, horizon)
        if windows is None:
            continue
        problem = Shooting(one, weight[run : run + 1], horizon, windows)
        records = np.repeat(hypothesis.records(trials.boat, x[run : run + 1]), windows.count)
        states = problem.guess()
        states[:, :3] = true_pose(states[:, :3], states[:, 3:], records)
        prediction = problem.predict(hypothesis, x[run : run + 1], states[None])[0]
        ends = windows.first + windows.steps
        measured = np.where(weight[run, ends] > 0, one.measured[0, ends], np.nan)
        error = measured - prediction[:, -1]
        error[:, 2] = wrap(error[:, 2])
        found.append(error)
    return np.concatenate(found) if found else np.zeros((0, len(CHANNELS)))


def _restarts(trials: Trials, horizon: float) -> Windows | None:
    steps = round(horizon / trials.dt)
    every = max(1, round(max(horizon, RESTART) / trials.dt))
    first = np.arange(math.ceil(SETTLING / trials.dt), int(trials.lengths[0]) - steps, every)
    if len(first) == 0:
        return None
    nothing = np.zeros((len(first), steps + 1, len(CHANNELS)))
    return Windows(
        np.zeros(len(first), int), first, np.full(len(first), steps), nothing, nothing, 0, steps + 1
    )


def change(before: Array, after: Array, rng: np.random.Generator) -> Change | None:
    """Of errors (n, k) in one quantity, n restarts; None where nothing was measured."""
    good = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    if good.sum() < 2:
        return None
    squares = np.stack([(before[good] ** 2).sum(axis=1), (after[good] ** 2).sum(axis=1)])
    picks = rng.integers(0, squares.shape[1], (RESAMPLES, squares.shape[1]))
    means = np.sqrt(squares[:, picks].mean(axis=2))
    low, high = np.percentile(means[0] - means[1], [2.5, 97.5])
    whole = np.sqrt(squares.mean(axis=1))
    return Change(float(whole[0]), float(whole[1]), (float(low), float(high)))
