"""Cross-validation: chi2 on held-out runs, and the bootstrap interval of its reduction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit_states, inverse
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def heldout_loss(problem: Shooting, at: Fit) -> Array:
    """(W,) chi2 of each window under the parameters fitted to the other runs alone (leave-one-run-out).

    One Newton step without a run's own windows, the loss there to second order with the initial states
    eliminated. Folds as in `folds_of`.
    """
    if at.hypothesis.size == 0:
        return at.loss
    runs = folds_of(problem.windows, at.hypothesis.differs)
    H, g = at.normal.information, at.normal.gradient
    loss = at.loss.copy()
    for run in np.unique(runs):
        mine = runs == run
        step = _newton_step(at, ~mine)
        change = -2.0 * g[mine] @ step + np.einsum("wij,i,j->w", H[mine], step, step)
        loss[mine] += np.where(np.isfinite(change), change, 0.0)  # not where a Jacobian diverged
    return loss


def folds_of(windows: Windows, halves: bool = False) -> NDArray[np.int64]:
    """(W,) fold of each window: its run where there are `enough_runs`, else half a run; of a single run each
    window. halves: half a run in any case, for parameters that each run has its own of.
    """
    count = len(np.unique(windows.run))
    if count >= options().enough_runs and not halves:
        return windows.run
    return np.arange(windows.count) if count == 1 else halves_of(windows)


def halves_of(windows: Windows) -> NDArray[np.int64]:
    """(W,) fold of each window: twice its run, and one more in the second half of that."""
    middle = np.zeros(int(windows.run.max()) + 1)
    for run in np.unique(windows.run):
        middle[run] = np.median(windows.first[windows.run == run])
    return np.asarray(2 * windows.run + (windows.first > middle[windows.run]))


def heldout_numbers(problem: Shooting, at: Fit) -> Array:
    """(R, p) parameters fitted to all runs but each one; those of the fit where there is one run. What the
    others say nothing of, such as the weather of that run alone, is fitted to it beside the rest.
    """
    runs = len(problem.run_set.lengths)
    if runs == 1 or at.hypothesis.size == 0:
        return np.repeat(at.x[None], runs, axis=0)
    numbers = numbers_without(at, problem.windows.run, runs)
    low, high = at.hypothesis.bounds()
    for run, x in enumerate(numbers):
        mine = problem.windows.run == run
        others, H = (at.normal.information[chosen].sum(axis=0) for chosen in (~mine, mine))
        own = (np.diag(others) == 0.0) & (at.hypothesis.prior()[1] == 0.0)
        g = at.normal.gradient[mine].sum(axis=0) - H[:, ~own] @ (x - at.x)[~own]
        x[own] = np.clip(x[own] + _solved(H[np.ix_(own, own)], g[own]), low[own], high[own])
    return numbers


def numbers_without(at: Fit, fold: NDArray[np.int64], folds: int) -> Array:
    """(folds, p) parameters fitted to all windows but those of each fold, by one Newton step; fold: (W,)."""
    low, high = at.hypothesis.bounds()
    numbers = np.empty((folds, at.hypothesis.size))
    for number in range(folds):
        numbers[number] = np.clip(at.x + _newton_step(at, fold != number), low, high)
    return numbers


def _newton_step(at: Fit, chosen: NDArray[np.bool_]) -> Array:
    """(p,) from a fit towards that to the chosen windows (W,) alone."""
    mean, precision = at.hypothesis.prior()
    H = at.normal.information[chosen].sum(axis=0) + np.diag(precision)
    return _solved(H, at.normal.gradient[chosen].sum(axis=0) - precision * (at.x - mean))


def _solved(H: Array, g: Array) -> Array:
    """(p,) Newton's step for information H and gradient g, none where a Jacobian diverged."""
    known = np.isfinite(H).all() and np.isfinite(g).all()
    return np.asarray(inverse(H) @ g) if known else np.zeros(len(g))


def judged_numbers(problem: Shooting, at: Fit, runs: int, others: bool) -> tuple[Hypothesis, Array]:
    """A hypothesis and its parameters (R, p) for predictions of so many runs; others: they are not those of
    the fit, so that only what its runs share is known of them.
    """
    if not others:
        return at.hypothesis, heldout_numbers(problem, at)
    hypothesis, x = at.hypothesis.shared(at.x)
    return hypothesis, np.repeat(x[None], runs, axis=0)


@dataclass(frozen=True)
class Confirmation:
    """Whether a cause lowers chi2 on runs that the parameters were not fitted to.

    gain: of the saturated loss; low: lower end of its interval at `level`, corrected for the number of
    candidates; significant: whether a likelihood ratio test finds it beside errors of the model's curves,
    None where there was no such test. It decides where no other run has a part in the cause.
    """

    gain: float
    low: float
    level: float
    significant: bool | None = None

    @property
    def holds(self) -> bool:
        """Whether the interval of the gain excludes zero, or a gain is significant by that test."""
        return self.low > 0.0 if self.significant is None else self.significant and self.gain > 0.0

    @property
    def gains(self) -> bool:
        """Whether held-out runs are predicted better, significantly or not."""
        return self.gain > 0.0


def confirmation(problem: Shooting, whole: Fit, less: Fit, comparisons: int) -> Confirmation:
    """Of what `whole` has more than `less`, both fitted on the same windows: block bootstrap of the gain over
    windows, at a level divided by the number of comparisons (Bonferroni).

    Percentiles, since a cause that acts in few windows gives a skewed sum. The loss of a window saturates, n
    ln(1 + chi2 / n), so that a few outlying windows do not determine the sum.
    """
    return confirmed_at(saturated_loss(problem, less) - saturated_loss(problem, whole), comparisons)


def confirmed_at(gains: Array, comparisons: int) -> Confirmation:
    """Of the gains of blocks (B,): their sum and the lower end of its bootstrap interval."""
    tail = options().tail / comparisons
    return Confirmation(float(gains.sum()), bootstrap_quantile(gains, tail), 1.0 - 2.0 * tail)


def bootstrap_quantile(gains: Array, tail: float) -> float:
    """The lower quantile of the bootstrap distribution of a sum of values (B,), without drawing it.

    Saddlepoint approximation of the tail of a sum of B draws with replacement, whose cumulant generating
    function is B ln mean exp(t gains) (Davison and Hinkley, Saddlepoint approximations in resampling methods,
    Biometrika 75, 1988): Lugannani and Rice's formula. tail: below 0.5, however far out.
    """
    from scipy.optimize import brentq
    from scipy.special import logsumexp, ndtr

    count, scale = len(gains), float(np.std(gains))
    if not scale > 1e-12 * float(np.abs(gains).max(initial=0.0)):
        return float(gains.sum())
    mean = float(gains.mean())
    unit = (gains - mean) / scale

    def at(t: float) -> tuple[float, float]:
        """Sum and log of the tail probability below it at a saddlepoint t < 0."""
        weights = np.exp(t * unit - logsumexp(t * unit))
        slope = float(weights @ unit)
        bend = float(weights @ (unit - slope) ** 2)
        cumulant = count * float(logsumexp(t * unit) - np.log(count))
        root = -np.sqrt(max(2.0 * (t * count * slope - cumulant), 1e-300))
        lever = t * np.sqrt(max(count * bend, 1e-300))
        density = np.exp(-0.5 * root**2) / np.sqrt(2.0 * np.pi)
        return count * slope, float(ndtr(root) + density * (1.0 / root - 1.0 / lever))

    least = float(np.mean(unit < unit.min() + 1e-9)) ** count  # chance that every draw is the least value
    if tail <= least:
        return count * float(gains.min())
    last = -1.0
    while at(last)[1] > tail:
        last *= 2.0
        if last < options().largest_tilt:
            return count * float(gains.min())
    found = brentq(lambda t: at(t)[1] - tail, last, options().least_tilt, xtol=1e-9)
    return count * mean + scale * at(float(found))[0]


def stretch_losses(problem: Shooting, at: Fit) -> Array:
    """(W S,) saturated loss of each stretch of each window; not finite where nothing was measured."""
    residual = at.residual.copy()
    if at.hypothesis.size:
        for run, x in enumerate(heldout_numbers(problem, at)):
            mine = problem.windows.run == run
            if mine.any():
                states = at.states[mine]
                residual[mine] = fit_states(
                    problem.part(mine), at.hypothesis, x, states, options().held_out_rounds
                )[2]
    rows = max(1, round(options().stretch / problem.dt))
    squares = (residual**2).reshape(len(residual), -1, problem.windows.weight.shape[2]).sum(axis=2)
    starts = np.arange(0, squares.shape[1], rows)
    chi2 = np.add.reduceat(squares, starts, axis=1)
    seen = np.add.reduceat((problem.windows.weight > 0).sum(axis=2), starts, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(seen > 0, seen * np.log1p(chi2 / seen), np.nan).ravel())


def saturated_loss(problem: Shooting, at: Fit) -> Array:
    """(W,) saturated held-out chi2 of each window."""
    return saturated(problem, heldout_loss(problem, at))


def saturated(problem: Shooting, loss: Array) -> Array:
    """(W,) n ln(1 + chi2 / n) of each window's chi2 (W,), n being its effective number of samples."""
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)) / problem.correlation_samples, 1.0)
    return np.asarray(seen * np.log1p(np.maximum(loss, 0.0) / seen))


def bootstrap_interval(gains: Array, share: float, rng: np.random.Generator) -> tuple[float, float]:
    """Interval of the sum of per-block gains (B,), each end leaving out half of 1 - share."""
    picks = rng.integers(0, len(gains), (options().loss_resamples, len(gains)))
    sums = gains[picks].sum(axis=1)
    tail = 100.0 * (1.0 - share) / 2.0
    low, high = np.percentile(sums, [tail, 100.0 - tail])
    return float(low), float(high)
