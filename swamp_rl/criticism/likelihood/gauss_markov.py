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

SIZE, SECONDS, WHITE = range(3)  # columns of a process


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
    """For a process (6, 3) as of `RunSet`.

    Every window begins in the stationary distribution; a prior in its first row is no measurement.
    """
    sizes = process[:, SIZE] * windows.weight[:, windows.pad :].max(axis=(0, 1))
    keep = np.where(sizes > 0.0, np.exp(-dt / np.maximum(process[:, SECONDS], dt)), 0.0)
    seen = windows.weight > 0
    if windows.pad > 0:
        seen[:, 0] = False
    gain, scale = np.zeros(seen.shape), np.zeros(seen.shape)
    filter_gains(sizes**2, process[:, WHITE] ** 2, keep, seen, gain, scale)
    return Filter(keep, gain, scale)


def fit_gauss_markov(windows: Windows, difference: Array, dt: float, least_white: float = 1.0) -> Array:
    """(6, 3) process as of `RunSet` at maximum likelihood, white noise where that is as likely; difference:
    (W, T, 6) measured less predicted, standardised.

    North and east are of one receiver: their processes are alike. Third differences hold the steps of a
    process too: white noise of positions beside it may be less than they say, down to `least_white` of it.
    """
    weight = windows.weight[:, windows.pad :].max(axis=(0, 1))
    unit = np.where(weight > 0.0, 1.0 / np.maximum(weight, 1e-12), 0.0)
    unit[POSITIONS] = unit[POSITIONS].max()
    best = white_noise()
    least = _minus_two_log_likelihood(windows, difference, best, dt) - options().wander_gain
    for seconds, size in itertools.product(options().wander_times, options().wander_sizes):
        process = white_noise()
        process[:, SIZE], process[:, SECONDS] = size * unit, seconds
        found = _minus_two_log_likelihood(windows, difference, process, dt)
        better = found < least
        best[better], least[better] = process[better], found[better]
    best[weight == 0.0] = white_noise()[0]
    return _likeliest(windows, difference, best, dt, least_white) if (best[:, SIZE] > 0.0).any() else best


def _likeliest(windows: Windows, difference: Array, begin: Array, dt: float, least_white: float) -> Array:
    """(6, 3) process at maximum likelihood, from the one to begin with.

    The likelihood of a channel depends on its own process alone: a step of one column in all channels gives
    all derivatives by it.
    """
    from scipy.optimize import minimize

    here = begin[:, SIZE] > 0.0
    alike = np.where(np.arange(len(CHANNELS)) < POSITIONS.stop, max(1, here[POSITIONS].sum()), 1)[here]

    def deviances(log: Array) -> Array:
        process = white_noise()
        process[here] = np.exp(log)
        return _minus_two_log_likelihood(windows, difference, process, dt)[here] / alike

    def deviance(flat: Array) -> tuple[float, Array]:
        log = flat.reshape(-1, 3)
        base, step = deviances(log), options().wander_step
        slopes = [(deviances(log + step * column) - base) / step for column in np.eye(3)]
        return float(base.sum()), np.stack(slopes, axis=1).reshape(-1)

    sizes, times = np.array(options().wander_sizes), options().wander_times
    bounds = [
        bound
        for channel in np.flatnonzero(here)
        for bound in (
            np.log(begin[channel, SIZE] * sizes[[0, -1]] / sizes[[-1, 0]]),
            np.log([times[0], times[-1]]),
            np.log([least_white if channel < POSITIONS.stop else 1.0, 1.0]),
        )
    ]
    found = minimize(deviance, np.log(begin[here]).reshape(-1), jac=True, method="L-BFGS-B", bounds=bounds)
    made = begin.copy()
    made[here] = np.exp(found.x.reshape(-1, 3))
    return made


def white_noise() -> Array:
    """(6, 3) processes of no size."""
    return np.tile([0.0, 0.0, 1.0], (len(CHANNELS), 1))


def _minus_two_log_likelihood(windows: Windows, difference: Array, process: Array, dt: float) -> Array:
    """(6,) of each channel, of both positions together, but for a constant."""
    made = kalman_filter(windows, process, dt)
    innovation = made.whitened(difference[None].copy())[0]
    seen = made.scale > 0
    variance = np.log(np.where(seen, made.scale, 1.0))
    found = np.where(seen, innovation**2 - 2.0 * variance, 0.0).sum(axis=(0, 1))
    found[POSITIONS] = found[POSITIONS].sum()
    return np.asarray(found)
