"""Measurement noise as the sum of white noise and a first-order Gauss-Markov process, and its whitening."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS, POSITIONS
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.model.rollout import filter_gains, whiten
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Filter:
    """The Kalman filter whose innovations are white.

    keep: (6,) autocorrelation of the process over one step, 0 where there is none; gain, scale: (W, T, 6)
    Kalman gain and 1 / innovation standard deviation, 0 where nothing was measured.
    """

    keep: Array
    gain: Array
    scale: Array

    def part(self, chosen: NDArray[np.bool_]) -> "Filter":
        """Of some windows (W,)."""
        return Filter(self.keep, self.gain[chosen], self.scale[chosen])

    def whitened(self, values: Array) -> Array:
        """Standardised values (..., W, T, 6) as innovations, in place where they are contiguous."""
        values = np.ascontiguousarray(values)
        whiten(values.reshape(-1, *values.shape[-3:]), self.keep, self.gain, self.scale)
        return values


def kalman_filter(windows: Windows, process: Array, dt: float) -> Filter:
    """For a process (6, 2): standard deviation [the channel's unit] and time constant [s] of each channel.

    Every window begins in the stationary distribution; a prior in its first row is no measurement.
    """
    sizes = process[:, 0] * windows.weight[:, windows.pad :].max(axis=(0, 1))
    keep = np.where(sizes > 0.0, np.exp(-dt / np.maximum(process[:, 1], dt)), 0.0)
    seen = windows.weight > 0
    if windows.pad > 0:
        seen[:, 0] = False
    gain, scale = np.zeros(seen.shape), np.zeros(seen.shape)
    filter_gains(sizes**2, keep, seen, gain, scale)
    return Filter(keep, gain, scale)


def fit_gauss_markov(windows: Windows, difference: Array, dt: float) -> Array:
    """(6, 2) standard deviation and time constant [s] of each channel's process at maximum likelihood, 0
    where white noise is as likely; difference: (W, T, 6) measured less predicted, standardised. North and
    east are of one receiver: their processes are alike. The best point of a grid, then of ever finer ones
    about it.
    """
    weight = windows.weight[:, windows.pad :].max(axis=(0, 1))
    unit = np.where(weight > 0.0, 1.0 / np.maximum(weight, 1e-12), 0.0)
    unit[POSITIONS] = unit[POSITIONS].max()
    best = np.zeros((len(CHANNELS), 2))
    white = _minus_two_log_likelihood(windows, difference, np.zeros((len(CHANNELS), 2)), dt)
    least = white - options().wander_gain

    def take_better(process: Array) -> None:
        found = _minus_two_log_likelihood(windows, difference, process, dt)
        better = found < least
        best[better], least[better] = process[better], found[better]

    times, sizes = options().wander_times, options().wander_sizes
    for time, size in itertools.product(times, sizes):
        take_better(np.column_stack([size * unit, np.full(len(CHANNELS), time)]))
    for factors in options().wander_finer if best.any() else ():
        middle = best.copy()
        for signs in itertools.product((-1, 0, 1), repeat=2):
            finer = middle * np.array(factors) ** signs
            finer[:, 1] = np.clip(finer[:, 1], times[0], times[-1])
            take_better(finer)
    return np.where(weight[:, None] > 0.0, best, 0.0)


def _minus_two_log_likelihood(windows: Windows, difference: Array, process: Array, dt: float) -> Array:
    """(6,) of each channel, of both positions together, but for a constant."""
    made = kalman_filter(windows, process, dt)
    innovation = made.whitened(difference[None].copy())[0]
    seen = made.scale > 0
    variance = np.log(np.where(seen, made.scale, 1.0))
    found = np.where(seen, innovation**2 - 2.0 * variance, 0.0).sum(axis=(0, 1))
    found[POSITIONS] = found[POSITIONS].sum()
    return np.asarray(found)
