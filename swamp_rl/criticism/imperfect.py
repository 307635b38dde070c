"""Comparison with a model that errs by more than its sensors do: weighed by what it leaves, not by noise."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import CHANNELS, Trials
from swamp_rl.criticism.fit import Fit, fit, settle
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

LONGEST = 30.0  # s of a window, over which a wrong model does not stray too far to be compared
FEWEST = 12  # windows that all runs together should give
ROUNDS = 3  # times that the errors' size is told anew, beside a fit that was weighed by it
STEPS = 4  # Jacobians that such a fit may take
BEGIN = 12  # steps that the first states are given
POSITIONS = slice(0, 2)


@dataclass(frozen=True)
class Level:
    """A comparison weighed by the model's own errors, and the fit that they were told beside.

    errors: (6, 2) standard deviation [the channel's unit] of what is left in a window, 0 where nothing was
    measured, and time constant [s] after which it is as good as new.
    """

    problem: Shooting
    fit: Fit
    errors: Array

    @property
    def trials(self) -> Trials:
        """The trials, knowing how large the model's errors are and how long they last."""
        return replace(self.problem.trials, slow=self.errors)


def levelled(
    trials: Trials, weight: Array, hypothesis: Hypothesis, x: Array, states: Array | None = None
) -> Level:
    """Windows of half a minute, or shorter where the runs give too few, each channel's standard deviation
    being that of what the hypothesis leaves; north and east share one, or the direction in which a cause acts
    would count least.

    A sample is no independent evidence there: weights are less by the root of the samples that an error
    lasts, so that chi2 counts errors, not samples. weight: (R, T, 6); x: (p,); states: (W, 6) to begin with.
    """
    seconds = min(LONGEST, float(trials.lengths.sum() * trials.dt) / FEWEST)
    seen = weight > 0
    sigma = 1.0 / np.where(seen.any(axis=(0, 1)), weight.max(axis=(0, 1)), 1.0)
    problem = Shooting(trials, seen / sigma, seconds)
    if states is None:
        states = settle(problem, hypothesis, x, problem.guess(), BEGIN)[0]
    for _ in range(ROUNDS):
        made = fit(problem, hypothesis, x, states, STEPS)
        x, states = made.x, made.states
        sigma = sigma * left(problem, made)
        problem = Shooting(trials, seen / sigma, seconds)
    lasting = correlated(unweighed(problem, fit(problem, hypothesis, x, states, STEPS)))
    problem = Shooting(trials, seen / (sigma * np.sqrt(lasting)), seconds)
    problem.lasting = lasting
    sizes = np.where(seen.any(axis=(0, 1)), sigma, 0.0)
    times = np.full(len(CHANNELS), 0.5 * lasting * trials.dt)
    return Level(problem, fit(problem, hypothesis, x, states, STEPS), np.column_stack([sizes, times]))


def in_noise(at: Fit, problem: Shooting, weight: Array) -> Fit:
    """A fit to a level's comparison, what it leaves told in standard deviations of the sensors' noise;
    weight: (R, T, 6) by that noise.
    """
    own, noise = (np.maximum(one.max(axis=(0, 1)), 1e-12) for one in (problem.weight, weight))
    residual = at.residual.reshape(len(at.residual), -1, len(CHANNELS)) * (noise / own)
    return replace(at, residual=residual.reshape(at.residual.shape))


def unweighed(problem: Shooting, at: Fit) -> Array:
    """(W, T, 6) what a fit leaves, in standard deviations, without the rows that are only simulated."""
    return at.residual.reshape(len(at.residual), -1, len(CHANNELS))[:, problem.windows.pad :]


def left(problem: Shooting, at: Fit) -> Array:
    """(6,) root mean square of what a fit leaves in each channel, in standard deviations; 1 where nothing was
    measured.
    """
    seen = problem.windows.weight[:, problem.windows.pad :] > 0
    count = seen.sum(axis=(0, 1))
    power = (unweighed(problem, at) ** 2).sum(axis=(0, 1)) / np.maximum(count, 1)
    power[POSITIONS] = power[POSITIONS].mean()
    return np.where(count > 0, np.sqrt(np.maximum(power, 1e-12)), 1.0)


def correlated(errors: Array) -> float:
    """Samples that an error lasts, 1 where each is new: twice the sum of autocorrelations up to the first
    that is negative, over all channels of errors (W, T, 6) that hold any.
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
