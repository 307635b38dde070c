"""Whether two runs are the same motion, recorded once and imported twice."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

POSITIONS = "north", "east"
"""Columns that have another origin in another import."""
APART = {"time", "latitude", "longitude"}
"""Columns that are not compared: times may count from another instant, and not every import keeps places."""
ROUNDING = 1e-9
"""Of a value, relative and absolute [SI]: of numbers that were written as text."""
OF_AXES = 1e-3
"""Of the distance from the first row: by how much the axes of origins within 10 km differ."""


def same_motion(one: Columns, other: Columns) -> bool:
    """Whether columns (T,) of two runs agree to their rounding, positions (T,) [m] to their first row's.

    A run without heading, or of which nothing varies, agrees with none.
    """
    names = (one.keys() & other.keys()) - APART
    if "heading" not in names or not _ends_agree(one["heading"], other["heading"]):
        return False
    varies = False
    for name in names:
        first, second = one[name], other[name]
        known = np.isfinite(first)
        if not np.array_equal(known, np.isfinite(second)):
            return False
        if not known.any():
            continue
        first, second = first[known], second[known]
        tolerance = ROUNDING * (1.0 + np.abs(first))
        if name in POSITIONS:
            first, second = first - first[0], second - second[0]
            tolerance = tolerance + OF_AXES * np.abs(first).max()
        if (np.abs(first - second) > tolerance).any():
            return False
        varies |= float(np.ptp(first)) > 0.0
    return varies


def _ends_agree(first: Array, second: Array) -> bool:
    """Whether two columns have as many rows and the same first and last value: most runs differ there."""
    if len(first) != len(second) or not len(first):
        return False
    ends = ((first[i], second[i]) for i in (0, -1))
    return not any(abs(a - b) > ROUNDING * (1.0 + abs(a)) for a, b in ends)


def same_runs(runs: Sequence[Columns], others: Sequence[Columns] | None = None) -> list[tuple[int, int]]:
    """Index pairs of runs of which the second is the same motion, among `runs` or of them and `others`."""
    if others is None:
        pairs = ((i, k) for i in range(len(runs)) for k in range(i + 1, len(runs)))
        return [(i, k) for i, k in pairs if same_motion(runs[i], runs[k])]
    return [(i, k) for i, one in enumerate(runs) for k, other in enumerate(others) if same_motion(one, other)]
