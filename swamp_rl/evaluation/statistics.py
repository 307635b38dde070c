"""Intervals: how sure is a success rate, and a difference between two pilots on shared episodes."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swamp_rl.constants import Z95

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
    successes, n = int(successes), int(n)
    if not 0 <= successes <= n or n < 1:
        raise ValueError(f"there are no {successes} successes of {n} episodes")
    rate = successes / n
    twice = 2.0 * (n + Z95**2)
    middle = (2.0 * n * rate + Z95**2) / twice
    half = Z95 / twice * math.sqrt(4.0 * n * rate * (1.0 - rate) + Z95**2)
    low, high = middle - half if successes else 0.0, middle + half if successes < n else 1.0
    return Interval(rate, low, high, n)


def success_difference(a: ArrayLike, b: ArrayLike) -> Interval:
    """Difference of the success rates a − b over episodes driven by both pilots, with Tango's score interval.

    `a` and `b` (n,) bool, in the same order of seeds (Tango 1998, Stat. Med. 17). The interval leaves out
    zero where McNemar's score test rejects equal rates, stays inside [-1, 1], and keeps a width where the two
    pilots agree in every episode, or differ in every one. ValueError where the shapes differ or n is 0.
    """
    from scipy.optimize import brentq

    difference = _differences(a, b)
    n, gained, lost = len(difference), int((difference > 0.0).sum()), int((difference < 0.0).sum())
    if not n:
        raise ValueError("no episode to compare")
    value = (gained - lost) / n

    def excess(d: float) -> float:
        # Above zero where the score test rejects the difference d; `only_b` is the chance, under d, of an
        # episode in which b alone succeeds (maximum likelihood).
        linear = (2 * n - gained + lost) * d - gained - lost
        root = math.sqrt(max(linear**2 + 8 * n * lost * d * (1.0 - d), 0.0))
        only_b = (root - linear) / (4 * n)
        return (gained - lost - n * d) ** 2 - Z95**2 * n * (2.0 * only_b + d * (1.0 - d))

    near = 1e-9  # the estimate itself is a root where the pilots agree in every episode
    low = -1.0 if lost == n else brentq(excess, -1.0, value - near)
    high = 1.0 if gained == n else brentq(excess, value + near, 1.0)
    return Interval(value, low, high, n)


def success_difference_of_seeds(a: ArrayLike, b: ArrayLike, rng: np.random.Generator) -> Interval:
    """Difference a − b of the success rates of several training seeds each, over episodes driven by all.

    `a` and `b` (n,) hold each episode's share of seeds that succeed. The ends are those of Gaffke (2005,
    Math. Methods Stat. 14; Learned-Miller and Thomas 2020, arXiv 1905.06208) for the mean of a bounded
    quantity: quantiles of Σ wᵢ dᵢ + w₀ e, w uniform on the simplex, e = −1 for the low end and 1 for the high
    one. They keep a width where the pilots agree in every episode. ValueError where the shapes differ or n
    is 0.
    """
    difference = _differences(a, b)
    n = len(difference)
    if not n:
        raise ValueError("no episode to compare")
    sums, ends, totals = [], [], []
    for _ in range(RESAMPLES // 100):
        weights = rng.standard_exponential((100, n + 1))
        sums.append(weights[:, 1:] @ difference)
        ends.append(weights[:, 0])
        totals.append(weights.sum(axis=1))
    drawn, end, total = (np.concatenate(parts) for parts in (sums, ends, totals))
    low, high = np.quantile((drawn - end) / total, ENDS[0]), np.quantile((drawn + end) / total, ENDS[1])
    return Interval(float(difference.mean()), float(low), float(high), n)


def with_episodes(found: Interval, episodes: int) -> Interval:
    """A success rate over training seeds, its interval widened by the chance of their common episodes.

    The distances to the ends of the interval and to those of Wilson's over the episodes are added in squares
    (Newcombe 1998, Stat. Med. 17, 873, method 10; Zou and Donner 2008, Stat. Med. 27).
    """
    own = wilson(round(found.value * episodes), episodes)
    low = found.value - math.hypot(found.value - found.low, own.value - own.low)
    high = found.value + math.hypot(found.high - found.value, own.high - own.value)
    return Interval(found.value, max(low, 0.0), min(high, 1.0), found.n)


def paired_difference(
    a: ArrayLike, b: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES
) -> Interval:
    """Mean of a − b over episodes driven by both pilots, with an expanded bootstrap percentile interval.

    `a` and `b` (n,) hold one number per episode, in the same order of seeds; pairs in which either is NaN
    (a time to the finish in a failed episode, say) are left out. Episodes are resampled in pairs, so what
    the episodes have in common cancels. The quantiles of the ends are those of Hesterberg (2015, Am. Stat.
    69), which widen the interval of few pairs; with fewer than about five it is still too narrow, one pair
    has none (NaN), and with none left the mean is NaN too and n is 0. Successes: `success_difference`.
    resamples: how many, in hundreds. ValueError where the shapes differ.
    """
    from scipy.stats import norm
    from scipy.stats import t as student_t

    difference = _differences(a, b)
    n = len(difference)
    if n == 0:
        return Interval(float("nan"), float("nan"), float("nan"), 0)
    if n == 1:
        return Interval(float(difference[0]), float("nan"), float("nan"), 1)
    picks = (rng.integers(0, n, (100, n), dtype=np.int32) for _ in range(resamples // 100))
    means = [difference[pick].mean(axis=1) for pick in picks]
    tail = norm.sf(math.sqrt(n / (n - 1)) * student_t.ppf(ENDS[1], n - 1))
    low, high = np.quantile(np.concatenate(means), (tail, 1.0 - tail))
    return Interval(float(difference.mean()), float(low), float(high), n)


def _differences(a: ArrayLike, b: ArrayLike) -> NDArray[np.float64]:
    first, second = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if first.shape != second.shape or first.ndim != 1:
        raise ValueError(
            f"paired arrays have one number per episode; got shapes {first.shape}, {second.shape}"
        )
    difference = first - second
    return difference[np.isfinite(difference)]
