"""Intervals: how sure is a success rate, and a difference between two pilots on shared episodes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

CONFIDENCE = 0.95  # of every interval
ENDS = (1.0 - CONFIDENCE) / 2.0, 1.0 - (1.0 - CONFIDENCE) / 2.0  # quantiles of its two ends
RESAMPLES = 2000


@dataclass(frozen=True)
class Interval:
    """An estimate with the two ends of its confidence interval; `n` is how many episodes it rests on."""

    value: float
    low: float
    high: float
    n: int


def wilson(successes: int, n: int) -> Interval:
    """Success rate with Wilson's score interval (Wilson 1927; method 3 of Newcombe 1998, Stat. Med. 17).

    Unlike rate ± 1.96 standard errors it stays inside [0, 1] and keeps a width at 0 and at n successes.
    ValueError unless 0 <= successes <= n and n >= 1.
    """
    from scipy.stats import binomtest

    result = binomtest(int(successes), int(n))
    ends = result.proportion_ci(CONFIDENCE, method="wilson")
    return Interval(result.statistic, float(ends.low), float(ends.high), int(n))


def paired_difference(
    a: ArrayLike, b: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES
) -> Interval:
    """Mean of a − b over episodes driven by both pilots, with a bootstrap percentile interval.

    `a` and `b` (n,) hold one number per episode, in the same order of seeds; pairs in which either is NaN
    (a time to the finish in a failed episode, say) are left out. Episodes are resampled in pairs, so what
    the episodes have in common cancels. With no pair left the interval is NaN and its n is 0.
    resamples: how many, in hundreds. ValueError where the shapes differ.
    """
    difference = _differences(a, b)
    n = len(difference)
    if n == 0:
        return Interval(float("nan"), float("nan"), float("nan"), 0)
    picks = (rng.integers(0, n, (100, n), dtype=np.int32) for _ in range(resamples // 100))
    means = [difference[pick].mean(axis=1) for pick in picks]
    low, high = np.quantile(np.concatenate(means), ENDS)
    return Interval(float(difference.mean()), float(low), float(high), n)


def _differences(a: ArrayLike, b: ArrayLike) -> NDArray[np.float64]:
    first, second = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if first.shape != second.shape or first.ndim != 1:
        raise ValueError(
            f"paired arrays have one number per episode; got shapes {first.shape}, {second.shape}"
        )
    difference = first - second
    return difference[np.isfinite(difference)]
