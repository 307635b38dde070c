"""Could a mean difference be chance? Signs flipped at random tell; corrected when many are asked."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

EXACT = 12
"Up to so many differences that are not zero, every pattern of signs is tried."
RESAMPLES = 9999
BATCH = 1000


def sign_flip_test(
    differences: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES, greater: bool = False
) -> float:
    """p-value of the mean of paired differences (n,) under signs that might as well be flipped.

    Fisher's randomisation test for pairs (The Design of Experiments, 1935, section 21). NaN are left out;
    zeros say nothing about the sign and do not change the result. Exact where the differences are all of one
    size (then it is McNemar's test, a binomial one) and up to `EXACT` of them; else from `resamples` patterns
    drawn with `rng`, the observed one counted among them (Phipson and Smyth 2010), so that it is never below
    1 / (resamples + 1). Two-sided, or with `greater` against a mean above zero. 1 with nothing but zeros.
    """
    d = np.asarray(differences, dtype=float).ravel()
    d = d[np.isfinite(d) & (d != 0.0)]
    if not len(d):
        return 1.0
    alternative = "greater" if greater else "two-sided"
    if np.ptp(np.abs(d)) <= 1e-12 * np.abs(d).max():
        from scipy.stats import binomtest

        return float(binomtest(int((d > 0.0).sum()), len(d), alternative=alternative).pvalue)
    if len(d) <= EXACT:
        from scipy.stats import permutation_test

        found = permutation_test(
            (d,), np.mean, permutation_type="samples", alternative=alternative, n_resamples=np.inf
        )
        return float(found.pvalue)
    return _drawn(d, rng, resamples, greater)


def _drawn(d: Array, rng: np.random.Generator, resamples: int, greater: bool) -> float:
    """The Monte Carlo p-value; a bit a sign, which is some hundred times faster than scipy's general test."""
    observed, total = float(d.sum()), 0
    slack = 1e-9 * float(np.abs(d).sum())  # of two sums that are equal but for rounding
    for begin in range(0, resamples, BATCH):
        rows = min(BATCH, resamples - begin)
        packed = rng.integers(0, 256, (rows, -(-len(d) // 8)), dtype=np.uint8)
        positive = np.unpackbits(packed, axis=1, count=len(d)).astype(float)
        sums = 2.0 * (positive @ d) - observed
        sums, bar = (sums, observed) if greater else (np.abs(sums), abs(observed))
        total += int((sums >= bar - slack).sum())
    return (total + 1) / (resamples + 1)


def holm(p_values: Sequence[float]) -> list[float]:
    """p-values corrected for their number, in their order: Holm (1979), Scand. J. Statist. 6.

    The chance that any true null hypothesis falls below the level stays within it, whatever the dependence.
    NaN is a comparison that was not made: it stays NaN and is not counted.
    """
    p = np.asarray(p_values, dtype=float)
    made = np.flatnonzero(np.isfinite(p))
    order = made[np.argsort(p[made], kind="stable")]
    steps = p[order] * (len(order) - np.arange(len(order)))
    corrected = np.full(len(p), np.nan)
    corrected[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return corrected.tolist()
