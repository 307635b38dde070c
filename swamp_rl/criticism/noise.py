"""The sensors' noise, told from the data alone, and samples that no noise explains."""

import warnings

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import CHANNELS, Trials

Array = NDArray[np.float64]

# What a channel's sigma is never taken to be below: data without noise still differ from a rollout by
# the integration step.
FLOOR = np.array([2e-3, 2e-3, 5e-4, 1e-3, 1e-3, 5e-4])
GAIN_OF_THIRD_DIFFERENCE = np.sqrt(20.0)  # of white noise: 1 + 9 + 9 + 1
CLIP = 4.0  # sigmas beyond which a third difference is a jump of the boat's, or an outlier
OUTLIER = 6.0  # sigmas from the median of its neighbours
NEIGHBOURS = 7


def noise_levels(trials: Trials) -> Array:
    """(6,) standard deviation of each channel's white noise, NaN for a channel that no run has.

    From third differences, in which a boat's motion at 10 Hz all but vanishes: a median (MAD) first, then the
    root mean square of what lies within four of it.
    """
    sigmas = np.full(len(CHANNELS), np.nan)
    fresh = np.where(held_samples(trials.measured), np.nan, trials.measured)
    for channel in range(len(CHANNELS)):
        differences = np.concatenate([third_differences(run[:, channel]) for run in fresh])
        differences = differences[np.isfinite(differences)]
        if len(differences) == 0:
            continue
        rough = 1.4826 * np.median(np.abs(differences))
        near = differences[np.abs(differences) <= CLIP * max(rough, 1e-12)]
        sigma = np.sqrt(np.mean(near**2)) / GAIN_OF_THIRD_DIFFERENCE if len(near) else 0.0
        sigmas[channel] = max(float(sigma), FLOOR[channel])
    return sigmas


def third_differences(values: Array) -> Array:
    """Of samples in a row (T,); where a sensor is slower than the grid, of its own samples."""
    if np.isfinite(values).mean() < 0.6:
        values = values[np.isfinite(values)]
    return np.diff(values, 3)


def weights(trials: Trials, sigmas: Array) -> Array:
    """(R, T, 6) 1/sigma, 0 where there is no sample, a repeated one or an outlier."""
    held = held_samples(trials.measured)
    good = np.isfinite(trials.measured) & ~held & ~outliers(trials.measured, sigmas)
    return good / np.where(np.isfinite(sigmas), sigmas, 1.0)


def held_samples(measured: Array) -> NDArray[np.bool_]:
    """(R, T, 6) samples that only repeat the one before to the last bit: a sensor that had nothing new
    to say.
    """
    held = np.zeros(measured.shape, dtype=bool)
    held[:, 1:] = measured[:, 1:] == measured[:, :-1]
    return held


def outliers(measured: Array, sigmas: Array) -> NDArray[np.bool_]:
    """(R, T, 6) samples farther than six sigmas from the median of themselves and six neighbours (Hampel)."""
    half = NEIGHBOURS // 2
    padded = np.pad(measured, ((0, 0), (half, half), (0, 0)), constant_values=np.nan)
    views = np.lib.stride_tricks.sliding_window_view(padded, NEIGHBOURS, axis=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of windows without any sample
        middle = np.nanmedian(views, axis=-1)
    return np.abs(measured - middle) > OUTLIER * sigmas
