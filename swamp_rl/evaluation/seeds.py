"""What is known of a training method from a few training seeds (Agarwal and others 2021, NeurIPS 34).

Scores are (S, M): one row for each of S training seeds, one column for each of M tasks (levels, say).
Intervals are percentile intervals of a stratified bootstrap: seeds are drawn anew within each task. With
fewer than about five seeds such an interval is too narrow, and with one there is none (NaN).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swamp_rl.evaluation.statistics import ENDS, RESAMPLES, Interval

Array = NDArray[np.float64]


def interquartile_mean(scores: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES) -> Interval:
    """Mean of the middle half of all scores (S, M) with its interval; n is S.

    Less moved by an outlier than the mean, and more certain than the median. ValueError for an empty array or
    one that is not two-dimensional.
    """
    table = _scores(scores)
    value = float(_iqm(table.ravel(), axis=-1))
    drawn = _iqm(_resampled(table, rng, resamples).reshape(resamples, -1), axis=-1)
    return _interval(value, drawn, len(table))


def mean_over_tasks(scores: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES) -> Interval:
    """Mean over the tasks of each task's interquartile mean over the seeds (S, M), with its interval; n is S.

    The interquartile mean of all scores leaves out the hardest and the easiest tasks, this one none.
    ValueError as `interquartile_mean`.
    """
    table = _scores(scores)
    value = float(_iqm(table, axis=0).mean())
    drawn = _iqm(_resampled(table, rng, resamples), axis=1).mean(axis=-1)
    return _interval(value, drawn, len(table))


def probability_of_improvement(a: ArrayLike, b: ArrayLike, rng: np.random.Generator) -> Interval:
    """Chance that a training of a scores above one of b, a tie counted half, averaged over the tasks.

    a (S, M), b (R, M) of the same tasks; Mann and Whitney's U over S R in each of them. n is the smaller of
    S and R. ValueError where the tasks differ in number.
    """
    first, second = _scores(a), _scores(b)
    if first.shape[1] != second.shape[1]:
        raise ValueError(f"scores of {first.shape[1]} and {second.shape[1]} tasks do not compare")
    value = float(_better(first, second))
    drawn = _better(_resampled(first, rng, RESAMPLES), _resampled(second, rng, RESAMPLES))
    return _interval(value, drawn, min(len(first), len(second)))


def curve_band(
    curves: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES
) -> tuple[Array, Array, Array]:
    """Interquartile mean over seeds of learning curves (S, T), and the two ends of its interval: each (T,).

    The band holds at each point by itself, not for the whole curve at once. Whole curves are drawn anew, so
    that neighbouring points keep what they have in common.
    """
    table = _scores(curves)
    picks = rng.integers(0, len(table), (resamples, len(table)))
    centre = _iqm(table, axis=0)
    if len(table) < 2:
        return centre, np.full(len(centre), np.nan), np.full(len(centre), np.nan)
    drawn = _iqm(table[picks], axis=1)
    low, high = np.quantile(drawn, ENDS, axis=0)
    return centre, low, high


def common_steps(curves: Sequence[tuple[ArrayLike, ArrayLike]]) -> tuple[Array, Array]:
    """Curves logged at different steps on one grid: steps (T,) and values (S, T).

    curves: steps and values of each seed. The grid is that of the curve with the fewest points, as far as all
    curves reach; between their points they are interpolated. ValueError where they have no range in common.
    """
    pairs = [(np.asarray(steps, float), np.asarray(values, float)) for steps, values in curves]
    first, last = max(steps[0] for steps, _ in pairs), min(steps[-1] for steps, _ in pairs)
    coarsest = min((steps for steps, _ in pairs), key=len)
    grid = coarsest[(coarsest >= first) & (coarsest <= last)]
    if not len(grid):
        raise ValueError("the curves have no range of steps in common")
    return grid, np.array([np.interp(grid, steps, values) for steps, values in pairs])


def _scores(scores: ArrayLike) -> Array:
    table = np.asarray(scores, dtype=float)
    if table.ndim != 2 or not table.size:
        raise ValueError(f"scores are (seeds, tasks), one of each at least; got the shape {table.shape}")
    return table


def _resampled(table: Array, rng: np.random.Generator, resamples: int) -> Array:
    """(resamples, S, M): seeds drawn with replacement, for each task by itself."""
    picks = rng.integers(0, len(table), (resamples, *table.shape))
    return table[picks, np.arange(table.shape[1])]


def _iqm(values: Array, axis: int) -> Array:
    from scipy.stats import trim_mean

    return trim_mean(values, 0.25, axis=axis)


def _better(a: Array, b: Array) -> Array:
    """(...) from a (..., S, M), b (..., R, M)."""
    first, second = a[..., :, None, :], b[..., None, :, :]
    return (0.5 * (first > second) + 0.5 * (first >= second)).mean(axis=(-3, -2, -1))


def _interval(value: float, drawn: Array, n: int) -> Interval:
    if n < 2:
        return Interval(value, float("nan"), float("nan"), n)
    low, high = np.quantile(drawn, ENDS)
    return Interval(value, float(low), float(high), n)
