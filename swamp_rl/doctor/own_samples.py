"""Channels that are sampled more slowly than the rows: held, or interpolated, between their own samples."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def holds(values: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First row and number of rows of each stretch of one value."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0.0) + 1])
    return starts, np.diff(np.append(starts, len(values)))


def usual_hold(values: Array) -> float:
    """Median of the rows between two changes, weighted by the change that ends them: of a boat at rest a
    sensor changes by its last digit, seldom."""
    starts, lengths = holds(values)
    if len(lengths) <= 5:
        return 0.0
    order = np.argsort(lengths[:-1], kind="stable")
    passed = np.cumsum(np.abs(np.diff(values[starts]))[order])
    return float(lengths[order[np.searchsorted(passed, 0.5 * passed[-1])]])


def usual_slope(values: Array) -> float:
    """Median rows of one slope: of a channel that was interpolated between slower samples, their distance."""
    span = float(np.ptp(values))
    return usual_hold(np.round(np.diff(values) / span, 9)) if span > 0.0 else 0.0


def between_samples(values: Array) -> tuple[Array, int]:
    """A channel (T,) interpolated between its own samples in place of held, and its rows between these.

    A held value is a sample at the first row that has it. Without held values the channel is as given; rows
    that were interpolated have the distance of their samples.
    """
    rows = round(usual_hold(values))
    if rows < 2:
        return values, max(1, round(usual_slope(values)))
    starts, _ = holds(values)
    return np.interp(np.arange(len(values)), starts, values[starts]), rows
