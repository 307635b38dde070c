"""Errors that wander: a first-order Gauss-Markov process beside white noise, and what whitens both."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import CHANNELS
from swamp_rl.criticism.kernel import filter_gains, whiten
from swamp_rl.criticism.windows import Windows

Array = NDArray[np.float64]

TIMES = (1.0, 3.0, 10.0, 30.0, 100.0)  # s, time constants looked at
SIZES = 0.15 * 2.0 ** np.arange(12)  # standard deviations looked at, in those of the white noise
WORTH = 25.0  # twice the log-likelihood that a wandering part must gain


@dataclass(frozen=True)
class Filter:
    """The Kalman filter whose innovations are white.

    keep: (6,) share of the wandering part that lasts a step, 0 where there is none; gain and scale
    (W, T, 6): of every sample, and one over its innovation's standard deviation, 0 where nothing was seen.
    """

    keep: Array
    gain: Array
    scale: Array

    def part(self, chosen: NDArray[np.bool_]) -> "Filter":
        """Of some windows (W,)."""
        return Filter(self.keep, self.gain[chosen], self.scale[chosen])

    def whitened(self, values: Array) -> Array:
        """Standardised values (..., W, T, 6) as innovations, in place where they lie in one piece."""
        values = np.ascontiguousarray(values)
        whiten(values.reshape(-1, *values.shape[-3:]), self.keep, self.gain, self.scale)
        return values


def filter_of(windows: Windows, slow: Array, dt: float) -> Filter:
    """For slow (6, 2): standard deviation [the channel's unit] and time constant [s] of each wandering part.

    Every window begins with the process anywhere in its stationary distribution; a held first row is no
    measurement.
    """
    sizes = slow[:, 0] * windows.weight[:, windows.pad :].max(axis=(0, 1))
    keep = np.where(sizes > 0.0, np.exp(-dt / np.maximum(slow[:, 1], dt)), 0.0)
    seen = windows.weight > 0
    if windows.pad > 0:
        seen[:, 0] = False
    gain, scale = np.zeros(seen.shape), np.zeros(seen.shape)
    filter_gains(sizes**2, keep, seen, gain, scale)
    return Filter(keep, gain, scale)


def slow_errors(windows: Windows, difference: Array, dt: float) -> Array:
    """(6, 2) standard deviation and time constant [s] of each channel's wandering part at greatest
    likelihood, 0 where white noise does as well; difference: (W, T, 6) measured less predicted, standardised.
    """
    unit = 1.0 / np.maximum(windows.weight[:, windows.pad :].max(axis=(0, 1)), 1e-12)
    best = np.zeros((len(CHANNELS), 2))
    white = _minus_twice_log(windows, difference, np.zeros((len(CHANNELS), 2)), dt)
    least = white - WORTH
    for time in TIMES:
        for size in SIZES:
            slow = np.column_stack([size * unit, np.full(len(CHANNELS), time)])
            found = _minus_twice_log(windows, difference, slow, dt)
            better = found < least
            best[better], least[better] = slow[better], found[better]
    return best


def _minus_twice_log(windows: Windows, difference: Array, slow: Array, dt: float) -> Array:
    """(6,) minus twice the log-likelihood of each channel, but for a constant."""
    made = filter_of(windows, slow, dt)
    innovation = made.whitened(difference[None].copy())[0]
    seen = made.scale > 0
    variance = np.log(np.where(seen, made.scale, 1.0))
    return np.asarray(np.where(seen, innovation**2 - 2.0 * variance, 0.0).sum(axis=(0, 1)))
