"""Weights from the model error, where it exceeds the measurement noise."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit, fit_states
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

POSITIONS = slice(0, 2)


@dataclass(frozen=True)
class ModelError:
    """Windows weighted by the model error, and the fit whose residual it was estimated from.

    errors: (6, 2) standard deviation [the channel's unit] of the residual, 0 where nothing was measured, and
    its correlation time [s].
    """

    problem: Shooting
    fit: Fit
    errors: Array

    @property
    def run_set(self) -> RunSet:
        """The runs with the model error as Gauss-Markov noise."""
        return replace(self.problem.run_set, gauss_markov=self.errors)

    @property
    def volume(self) -> float:
        """Sum of the logarithms of the standard deviations."""
        sizes = self.errors[:, 0]
        return float(np.log(sizes[sizes > 0.0]).sum())


def model_error(
    run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array, states: Array | None = None
) -> ModelError:
    """Windows of `model_error_window`, or shorter where the runs give too few, weighted by the standard
    deviation of each channel's residual; north and east have a common one, so that no direction is weighted
    less.

    Weights are divided by the root of the residual's integrated autocorrelation time, so that chi2 counts
    independent samples. weight: (R, T, 6); x: (p,); states: (W, 6) to begin with.
    """
    seconds = min(
        options().model_error_window,
        float(run_set.lengths.sum() * run_set.dt) / options().model_error_windows,
    )
    seen = weight > 0
    sigma = 1.0 / np.where(seen.any(axis=(0, 1)), weight.max(axis=(0, 1)), 1.0)
    problem = Shooting(run_set, seen / sigma, seconds)
    if states is None:
        states = fit_states(problem, hypothesis, x, problem.initial_states(), options().model_error_begin)[0]
    for _ in range(options().model_error_rounds):
        made = fit(problem, hypothesis, x, states, options().model_error_steps)
        x, states = made.x, made.states
        sigma = sigma * residual_rms(problem, made)
        problem = Shooting(run_set, seen / sigma, seconds)
    samples = correlation_samples(
        standardised_residual(problem, fit(problem, hypothesis, x, states, options().model_error_steps))
    )
    problem = Shooting(run_set, seen / (sigma * np.sqrt(samples)), seconds)
    problem.correlation_samples = samples
    sizes = np.where(seen.any(axis=(0, 1)), sigma, 0.0)
    times = np.full(len(CHANNELS), 0.5 * samples * run_set.dt)
    return ModelError(
        problem,
        fit(problem, hypothesis, x, states, options().model_error_steps),
        np.column_stack([sizes, times]),
    )


def in_noise_units(at: Fit, problem: Shooting, weight: Array) -> Fit:
    """A fit whose residual is in standard deviations of the measurement noise; weight: (R, T, 6) by that
    noise.
    """
    own, noise = (np.maximum(one.max(axis=(0, 1)), 1e-12) for one in (problem.weight, weight))
    residual = at.residual.reshape(len(at.residual), -1, len(CHANNELS)) * (noise / own)
    return replace(at, residual=residual.reshape(at.residual.shape))


def standardised_residual(problem: Shooting, at: Fit) -> Array:
    """(W, T, 6) residual of a fit in standard deviations, without the rows that are only simulated."""
    return at.residual.reshape(len(at.residual), -1, len(CHANNELS))[:, problem.windows.pad :]


def residual_rms(problem: Shooting, at: Fit) -> Array:
    """(6,) root mean square residual of each channel in standard deviations; 1 where nothing was measured."""
    seen = problem.windows.weight[:, problem.windows.pad :] > 0
    count = seen.sum(axis=(0, 1))
    power = (standardised_residual(problem, at) ** 2).sum(axis=(0, 1)) / np.maximum(count, 1)
    power[POSITIONS] = power[POSITIONS].mean()
    return np.where(count > 0, np.sqrt(np.maximum(power, 1e-12)), 1.0)


def correlation_samples(errors: Array) -> float:
    """Integrated autocorrelation time in samples, 1 for white noise: 1 + 2 times the sum of autocorrelations
    up to the first negative one, mean over the channels of errors (W, T, 6).
    """
    errors = errors[..., (errors != 0.0).any(axis=(0, 1))]
    if not errors.size:
        return 1.0
    power = (errors**2).sum(axis=(0, 1))
    total, alive = np.ones_like(power), np.ones(power.shape, dtype=bool)
    for lag in range(1, errors.shape[1] // 2):
        share = (errors[:, lag:] * errors[:, :-lag]).sum(axis=(0, 1)) / power
        alive &= share > 0.0
        if not alive.any():
            break
        total += 2.0 * np.where(alive, share, 0.0)
    return float(total.mean())
