"""Loss on runs that the numbers were not fitted to, and whether a gain there is more than chance."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.fit import Fit, inverse
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

RESAMPLES = 2000


def heldout_loss(problem: Shooting, at: Fit) -> Array:
    """(W,) chi2 of each window under the numbers that the other runs alone would give.

    One Newton step without a run's own windows, the loss there to second order with the initial states
    eliminated; with a single run, each window is held out instead.
    """
    if at.hypothesis.size == 0:
        return at.loss
    runs = problem.windows.run if len(set(problem.windows.run)) > 1 else np.arange(problem.windows.count)
    _, precision = at.hypothesis.prior()
    mean, _ = at.hypothesis.prior()
    H, g = at.normal.information, at.normal.gradient
    loss = at.loss.copy()
    for run in np.unique(runs):
        mine = runs == run
        rest = H[~mine].sum(axis=0) + np.diag(precision)
        step = inverse(rest) @ (g[~mine].sum(axis=0) - precision * (at.x - mean))
        loss[mine] += -2.0 * g[mine] @ step + np.einsum("wij,i,j->w", H[mine], step, step)
    return loss


def heldout_numbers(problem: Shooting, at: Fit) -> Array:
    """(R, p) the numbers that all runs but each one would give; those of the fit where there is one run."""
    windows = problem.windows.run
    runs = len(problem.trials.lengths)
    if runs == 1 or at.hypothesis.size == 0:
        return np.repeat(at.x[None], runs, axis=0)
    mean, precision = at.hypothesis.prior()
    numbers = np.empty((runs, at.hypothesis.size))
    low, high = at.hypothesis.bounds()
    for run in range(runs):
        others = windows != run
        H = at.normal.information[others].sum(axis=0) + np.diag(precision)
        g = at.normal.gradient[others].sum(axis=0) - precision * (at.x - mean)
        numbers[run] = np.clip(at.x + inverse(H) @ g, low, high)
    return numbers


def bootstrap_interval(gains: Array, share: float, rng: np.random.Generator) -> tuple[float, float]:
    """Interval of the sum of per-block gains (B,), each end leaving out half of 1 - share."""
    picks = rng.integers(0, len(gains), (RESAMPLES, len(gains)))
    sums = gains[picks].sum(axis=1)
    tail = 100.0 * (1.0 - share) / 2.0
    low, high = np.percentile(sums, [tail, 100.0 - tail])
    return float(low), float(high)
