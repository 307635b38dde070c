"""Loss on runs that the numbers were not fitted to, and whether a gain there is more than chance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.fit import Fit, inverse
from swamp_rl.criticism.settle import settle
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.criticism.windows import Windows

Array = NDArray[np.float64]

RESAMPLES = 2000
ENOUGH = 4  # runs, of which one can be held out whole and the others still show all
RARE = 50000  # resamples for a level far out in the tail
STRETCH = 20.0  # s of a long window that is a block of its own
ROUNDS = 8  # steps that the start of a window held out is given


def heldout_loss(problem: Shooting, at: Fit) -> Array:
    """(W,) chi2 of each window under the numbers that the other runs alone would give.

    One Newton step without a run's own windows, the loss there to second order with the initial states
    eliminated. Of few runs, halves are held out, of a single one each window.
    """
    if at.hypothesis.size == 0:
        return at.loss
    runs = held_together(problem.windows)
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


def held_together(windows: Windows) -> NDArray[np.int64]:
    """(W,) which windows are held out together: those of a run where there are enough runs to learn from
    without it, else those of half a run, or one by one.
    """
    every = np.unique(windows.run)
    if len(every) >= ENOUGH:
        return windows.run
    if len(every) == 1:
        return np.arange(windows.count)
    middle = np.array([np.median(windows.first[windows.run == run]) for run in every])
    place = np.searchsorted(every, windows.run)
    return np.asarray(2 * place + (windows.first > middle[place]))


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


@dataclass(frozen=True)
class Confirmation:
    """Whether a cause lowers the loss on runs that the numbers were not fitted to.

    gain: of the saturated loss; low: lower end of its interval at `level`, the share that the interval covers
    once the number of candidates that could have been picked is accounted for.
    """

    gain: float
    low: float
    level: float

    @property
    def holds(self) -> bool:
        """Whether the interval of the gain excludes zero."""
        return self.low > 0.0


def confirmation(problem: Shooting, whole: Fit, less: Fit, chances: int) -> Confirmation:
    """Of what `whole` has more than `less`, both fitted on the same windows, which are the blocks of a
    bootstrap of the sum, at a level divided by the number of chances (Bonferroni).

    Percentiles, not Student's distribution: a cause that acts in few windows gives a skewed sum, whose spread
    comes from the very gains that speak for it. The loss of a window saturates, n ln(1 + chi2 / n), or a few
    wild ones would hide the rest.
    """
    return _bootstrapped(saturated_loss(problem, less) - saturated_loss(problem, whole), chances)


def confirmation_by_stretches(problem: Shooting, whole: Fit, less: Fit, chances: int) -> Confirmation:
    """As `confirmation`, for windows that are too long and too few to be blocks: these are stretches of them,
    each window being followed, from a start of its own, under the numbers that the other runs alone give.
    """
    gains = stretch_losses(problem, less) - stretch_losses(problem, whole)
    return _bootstrapped(gains[np.isfinite(gains)], chances)


def stretch_losses(problem: Shooting, at: Fit) -> Array:
    """(W S,) saturated loss of each stretch of each window; not finite where nothing was measured."""
    residual = at.residual.copy()
    if at.hypothesis.size:
        for run, x in enumerate(heldout_numbers(problem, at)):
            mine = problem.windows.run == run
            if mine.any():
                states = at.states[mine]
                residual[mine] = settle(problem.part(mine), at.hypothesis, x, states, ROUNDS)[2]
    rows = max(1, round(STRETCH / problem.dt))
    squares = (residual**2).reshape(len(residual), -1, problem.windows.weight.shape[2]).sum(axis=2)
    starts = np.arange(0, squares.shape[1], rows)
    chi2 = np.add.reduceat(squares, starts, axis=1)
    seen = np.add.reduceat((problem.windows.weight > 0).sum(axis=2), starts, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(seen > 0, seen * np.log1p(chi2 / seen), np.nan).ravel())


def _bootstrapped(gains: Array, chances: int) -> Confirmation:
    """Of the gains of blocks (B,)."""
    tail = 0.025 / chances
    rng = np.random.default_rng(len(gains))
    shares = np.full(len(gains), 1.0 / len(gains))
    sums = rng.multinomial(len(gains), shares, RARE) @ gains
    return Confirmation(float(gains.sum()), float(np.quantile(sums, tail)), 1.0 - 2.0 * tail)


def saturated_loss(problem: Shooting, at: Fit) -> Array:
    """(W,) n ln(1 + chi2 / n) of each window's held-out chi2, n being its samples, or errors where those
    last.
    """
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)) / problem.lasting, 1.0)
    return np.asarray(seen * np.log1p(np.maximum(heldout_loss(problem, at), 0.0) / seen))


def bootstrap_interval(gains: Array, share: float, rng: np.random.Generator) -> tuple[float, float]:
    """Interval of the sum of per-block gains (B,), each end leaving out half of 1 - share."""
    picks = rng.integers(0, len(gains), (RESAMPLES, len(gains)))
    sums = gains[picks].sum(axis=1)
    tail = 100.0 * (1.0 - share) / 2.0
    low, high = np.percentile(sums, [tail, 100.0 - tail])
    return float(low), float(high)
