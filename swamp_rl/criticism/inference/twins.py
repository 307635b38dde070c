"""Twins of a diagnosis: runs simulated from its answer, with the commands, lengths, sampling and noise of the
measured ones.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.measurement_noise import repeated_samples
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.nuisance.smoothed_channels import Smoothing, third_difference_variance
from swamp_rl.criticism.selection.continuation import states_carried

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SensorNoise:
    """The noise of six channels (SI, rad).

    white: (6,) standard deviation of the white part; process: (P, 6, 2) standard deviations and time
    constants [s] of independent Gauss-Markov parts that are added to it.
    """

    white: Array
    process: Array

    def drawn(self, rng: np.random.Generator, runs: int, rows: int, dt: float) -> Array:
        """(R, T, 6) noise in rows of dt [s], each run begun in the stationary distribution."""
        found = self.white * rng.standard_normal((runs, rows, len(CHANNELS)))
        for size, seconds in np.moveaxis(self.process, 2, 1):
            found += gauss_markov(rng.standard_normal(found.shape), size, seconds, dt)
        return found


def gauss_markov(fresh: Array, size: Array, seconds: Array, dt: float) -> Array:
    """(R, T, 6) first-order Gauss-Markov processes of standard deviation `size` (6,) and time constant
    `seconds` (6,), from independent standard normal values.
    """
    from scipy.signal import lfilter

    found = np.zeros_like(fresh)
    for channel in np.flatnonzero(size > 0.0):
        keep = math.exp(-dt / max(float(seconds[channel]), 1e-9))
        driven = fresh[..., channel] * size[channel] * math.sqrt(1.0 - keep**2)
        driven[:, 0] = fresh[:, 0, channel] * size[channel]
        found[..., channel] = lfilter([1.0], [1.0, -keep], driven, axis=1)
    return found


def sensor_noise(
    sigmas: Array, smoothed: Mapping[str, Smoothing], gauss_markov: Array | None, dt: float
) -> SensorNoise:
    """The noise that a diagnosis estimated.

    sigmas: (6,) by channel, NaN where nothing was measured; smoothed: channels whose noise is white noise
    behind a filter of first order; gauss_markov: (6, 2) as in `RunSet`.
    """
    white = np.where(np.isfinite(sigmas), sigmas, 0.0)
    filtered = np.zeros((len(CHANNELS), 2))
    for channel, name in enumerate(CHANNELS):
        if name in smoothed:
            one = smoothed[name]
            pole = math.exp(-dt / one.time_constant)
            power = 20 * one.sample_noise**2 / third_difference_variance(pole, 1)
            white[channel], filtered[channel] = 0.0, (math.sqrt(power), one.time_constant)
    parts = [filtered] if smoothed else []
    return SensorNoise(
        white,
        np.array([*parts, *([] if gauss_markov is None else [gauss_markov])]).reshape(-1, len(CHANNELS), 2),
    )


def without_noise(logged: RunSet, judged: Shooting, answer: Fit) -> RunSet:
    """The runs as the answer predicts them from their first initial states on, unbroken and without noise.

    logged: the measured runs; judged: the windows that the answer was fitted to. What was not measured is
    missing here too, and the rows before the first that is compared with a simulation are the measured ones.
    """
    runs = replace(judged.run_set, gaps=(), gauss_markov=None)
    unbroken = Shooting(runs, judged.weight, np.inf)
    states = states_carried(judged, answer.states, unbroken, unbroken.initial_states())
    track = unbroken.predict(answer.hypothesis, answer.x[None], states[None])[0]
    measured, windows = logged.measured.copy(), unbroken.windows
    for run, first, steps, predicted in zip(windows.run, windows.first, windows.steps, track, strict=True):
        part = slice(first, first + steps + 1)
        measured[run, part] = np.where(np.isfinite(measured[run, part]), predicted[: steps + 1], np.nan)
    return replace(logged, measured=measured, gauss_markov=None)


def with_noise(logged: RunSet, ideal: RunSet, noise: Array) -> RunSet:
    """A twin: the runs `ideal` with noise (R, T, 6) where they were simulated, a sample repeated where the
    measured one, of the runs `logged`, repeats the one before.
    """
    simulated = ideal.measured != logged.measured
    measured = np.where(simulated, ideal.measured + noise, ideal.measured)
    fresh = ~repeated_samples(logged.measured)
    rows = np.arange(measured.shape[1])[:, None]
    last = np.maximum.accumulate(np.where(fresh, rows, 0), axis=1)
    return replace(ideal, measured=np.take_along_axis(measured, last, axis=1))
