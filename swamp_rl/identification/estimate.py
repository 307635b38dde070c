"""Least squares on rows of a time series, with intervals that account for autocorrelation."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Solve = Callable[[Array, Array], Array]

RESAMPLES = 400
BLOCK = 5.0  # s, several time constants of a small boat
SEED = 20


class Estimate(NamedTuple):
    """A number with its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


def pseudo_inverse(X: Array, y: Array) -> Array:
    """The least-squares solution (p,) of X (N, p) b = y (N,)."""
    return np.asarray(np.linalg.lstsq(X, y, rcond=None)[0], dtype=np.float64)


def blocks_of(lengths: Sequence[int], rows: int) -> list[NDArray[np.int64]]:
    """Row numbers of consecutive blocks of about `rows`, none across the end of a run of those lengths."""
    found: list[NDArray[np.int64]] = []
    start = 0
    for length in lengths:
        pieces = max(1, round(length / rows))
        found += [part for part in np.array_split(np.arange(start, start + length), pieces) if len(part)]
        start += length
    return found


def with_intervals(
    X: Array, y: Array, blocks: Sequence[NDArray[np.int64]], solve: Solve, units: Sequence[str]
) -> list[Estimate]:
    """Estimates (p,) of `solve`, with percentile intervals from resampled blocks of rows.

    The intervals show the scatter of the method; they know nothing of its bias.
    """
    value = solve(X, y)
    reduced = [_reduced(X[rows], y[rows]) for rows in blocks]
    rng = np.random.default_rng(SEED)
    resampled = []
    for _ in range(RESAMPLES):
        chosen = [reduced[i] for i in rng.integers(len(blocks), size=len(blocks))]
        resampled.append(solve(np.vstack([one[0] for one in chosen]), np.hstack([one[1] for one in chosen])))
    low, high = np.quantile(resampled, [0.025, 0.975], axis=0)
    columns = zip(value, low, high, units, strict=True)
    return [Estimate(float(v), float(a), float(b), unit) for v, a, b, unit in columns]


def _reduced(X: Array, y: Array) -> tuple[Array, Array]:
    """At most p + 1 rows with the same normal equations."""
    R = np.asarray(np.linalg.qr(np.column_stack([X, y]), mode="r"))
    return R[:, :-1], R[:, -1]
