"""White measurement noise, estimated from third differences of the data, and outliers."""

import warnings

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

NORMAL_OF_MAD = 1.4826  # standard deviation over median absolute value, of a normal distribution
GAIN_OF_THIRD_DIFFERENCE = np.sqrt(20.0)  # of the standard deviation of white noise: 1 + 9 + 9 + 1


def noise_levels(run_set: RunSet) -> Array:
    """(6,) standard deviation of each channel's white noise, NaN for a channel that no run has.

    From third differences, in which the motion of a boat sampled at 10 Hz is negligible: a median (MAD)
    first, then the root mean square of the differences within `difference_clip` of it.
    """
    sigmas, least = np.full(len(CHANNELS), np.nan), noise_floor(run_set.boat)
    fresh = np.where(repeated_samples(run_set.measured), np.nan, run_set.measured)
    for channel in range(len(CHANNELS)):
        differences = np.concatenate([third_differences(run[:, channel]) for run in fresh])
        differences = differences[np.isfinite(differences)]
        if len(differences) == 0:
            continue
        rough = NORMAL_OF_MAD * np.median(np.abs(differences))
        near = differences[np.abs(differences) <= options().difference_clip * max(rough, 1e-12)]
        sigma = np.sqrt(np.mean(near**2)) / GAIN_OF_THIRD_DIFFERENCE if len(near) else 0.0
        sigmas[channel] = max(float(sigma), least[channel])
    return sigmas


def noise_floor(boat: Boat) -> Array:
    """(6,) least standard deviation of each channel."""
    return np.asarray(np.array(options().noise_floor) * state_scale(boat))


def third_differences(values: Array) -> Array:
    """Of consecutive samples (T,); of the finite samples alone where a sensor is slower than the grid."""
    if np.isfinite(values).mean() < options().slow_sensor:
        values = values[np.isfinite(values)]
    return np.diff(values, 3)


def weights(run_set: RunSet, sigmas: Array) -> Array:
    """(R, T, 6) 1/sigma, 0 where there is no sample, a repeated one or an outlier."""
    held = repeated_samples(run_set.measured)
    good = np.isfinite(run_set.measured) & ~held & ~outliers(run_set.measured, sigmas)
    return good / np.where(np.isfinite(sigmas), sigmas, 1.0)


def repeated_samples(measured: Array) -> NDArray[np.bool_]:
    """(R, T, 6) whether a sample equals the one before to the last bit: no new measurement."""
    held = np.zeros(measured.shape, dtype=bool)
    held[:, 1:] = measured[:, 1:] == measured[:, :-1]
    return held


def outliers(measured: Array, sigmas: Array) -> NDArray[np.bool_]:
    """(R, T, 6) samples farther than `outlier` sigmas from the local median (Hampel filter)."""
    half = options().outlier_neighbours // 2
    padded = np.pad(measured, ((0, 0), (half, half), (0, 0)), constant_values=np.nan)
    views = np.lib.stride_tricks.sliding_window_view(padded, options().outlier_neighbours, axis=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of windows without any sample
        middle = np.nanmedian(views, axis=-1)
    return np.abs(measured - middle) > options().outlier * sigmas
