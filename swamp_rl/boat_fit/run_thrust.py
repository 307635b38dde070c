"""Thrust of each run as a share of an identified boat's, and the runs in which it is another."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.fit import SHORT, soft_weights
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit, fit_states, losses
from swamp_rl.criticism.model.candidates import Hypothesis, instances_of
from swamp_rl.criticism.nuisance.random_effect import random_effect
from swamp_rl.effects import LIBRARY

Array = NDArray[np.float64]

SCALES = (0.15, 0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0)  # of the thrust, from which the best is fitted
STATE_ROUNDS, STEPS = 8, 4
ORDINARY = 0.1  # standard deviation of log thrust between runs that is ordinary: the charge of a battery
LEVEL = 0.01  # chance that any of the runs is taken for another where all are alike
FEWEST = 6  # runs, of which most can be taken to be alike
CHI2_MEDIAN = 0.454936  # of one degree of freedom
EXPLAINED = 0.5  # of chi2 without thrust, that commands explain of the motion that they drive
UNUSUAL = 3.0  # times the median residual, beyond which a run's is unusual
DRAWS = 1000
HALVINGS = 40


@dataclass(frozen=True)
class RunThrust:
    """A run, or a piece of one, with its thrust as a share of the boat's and the standard error [1].

    rms: of the standardised residual at this share; explained: 1 − χ²/χ²₀ [1], χ²₀ without thrust.
    """

    name: str
    share: float
    standard_error: float
    rms: float = 1.0
    explained: float = 1.0


@dataclass(frozen=True)
class UnlikeRuns:
    """Runs that are not like most: of another thrust, and driven by other commands than the logged ones.

    fitted: names of the runs that the fit has.
    """

    thrust: tuple[RunThrust, ...] = ()
    commands: tuple[RunThrust, ...] = ()
    fitted: tuple[str, ...] = ()

    @property
    def names(self) -> set[str]:
        """Of both."""
        return {one.name for one in (*self.thrust, *self.commands)}


def unlike(every: Sequence[RunThrust]) -> UnlikeRuns:
    """The runs that are not like most of these."""
    undriven = with_other_commands(every)
    driven = [one for one in every if one not in undriven]
    return UnlikeRuns(tuple(with_other_thrust(driven)), tuple(undriven))


@dataclass(frozen=True)
class ThrustLevel:
    """Mean [1] of the thrust of runs as a share of a boat's, and its standard error."""

    mean: float = 1.0
    standard_error: float = 0.0


def thrust_level(usual: Sequence[RunThrust]) -> ThrustLevel:
    """The mean thrust of these runs where it differs from the boat's, else the boat's: 1 without error."""
    if len(usual) < 2:
        return ThrustLevel()
    level = mean_thrust(usual)
    return level if abs(level.mean - 1.0) > Z95 * level.standard_error else ThrustLevel()


def mean_thrust(usual: Sequence[RunThrust]) -> ThrustLevel:
    """The mean of the normal distribution that the shares of two or more runs are drawn from, by restricted
    maximum likelihood.
    """
    shares, errors = (np.array([getattr(one, key) for one in usual]) for key in ("share", "standard_error"))
    found = random_effect(shares[:, None], np.diag(errors**2), np.ones(1))
    return ThrustLevel(float(found.mean[0]), float(np.sqrt(found.covariance[0, 0])))


def at_level(every: Sequence[RunThrust], level: ThrustLevel) -> list[RunThrust]:
    """The same as shares of the boat whose thrust has this level."""
    return [
        replace(one, share=one.share / level.mean, standard_error=one.standard_error / level.mean)
        for one in every
    ]


@np.errstate(over="ignore", invalid="ignore")  # where the boat diverges at a scale
def run_thrusts(run_set: RunSet, boat: Boat) -> list[RunThrust]:
    """The factor of all thrust with which the boat fits each run best, by output error in short windows."""
    run_set = replace(run_set, boat=boat)
    weight = soft_weights(weights(run_set, noise_levels(run_set)), boat)
    hypothesis = Hypothesis((instances_of(LIBRARY["thrust_scale"], boat)[0],))
    problem = Shooting(run_set, weight, SHORT)
    measured, run = problem.initial_states(), problem.windows.run

    def at_scale(scale: float) -> tuple[Array, Array]:
        """Loss of each run (R,) and initial states (W, 6) of all runs, with their thrust scaled alike."""
        states, _, residual = fit_states(problem, hypothesis, np.array([scale]), measured, STATE_ROUNDS)
        return np.bincount(run, losses(residual), len(run_set.lengths)).astype(float), states

    tried, (none, _) = [at_scale(scale) for scale in SCALES], at_scale(0.0)
    found = []
    for k, best in enumerate(np.argmin([loss for loss, _ in tried], axis=0)):
        part, begun = problem.part(run == k), tried[best][1][run == k]
        made = fit(part, hypothesis, np.array([SCALES[best]]), begun, STEPS)
        left, error = made.loss.sum(), float(np.sqrt(made.covariance[0, 0]))
        rms, explained = float(np.sqrt(left / part.samples)), float(1.0 - left / none[k])
        found.append(RunThrust(run_set.names[k], float(made.x[0]), error, rms, explained))
    return found


def with_other_thrust(every: Sequence[RunThrust]) -> list[RunThrust]:
    """Runs whose thrust differs from the others' beyond chance; none where there are fewer than FEWEST.

    Under test is the distance of the log share from its median, standardised by the error of the estimate,
    were the share the median, and by the spread between runs. It is compared with the largest such distance
    of as many normal draws (parametric bootstrap), which any exceeds with the chance LEVEL.
    """
    if len(every) < FEWEST:
        return []
    log = np.log([one.share for one in every])
    errors = np.array([one.standard_error for one in every]) / np.exp(np.median(log))
    distances, between = standardised(log, errors)
    rng = np.random.default_rng(0)
    alike = rng.normal(0.0, np.hypot(errors, between), (DRAWS, len(every)))
    limit = np.quantile(standardised(alike, errors)[0].max(axis=-1), 1.0 - LEVEL)
    return [one for one, far in zip(every, distances > limit, strict=True) if far]


def with_other_commands(every: Sequence[RunThrust]) -> list[RunThrust]:
    """Runs that other commands than the logged ones drove; none where there are fewer than FEWEST.

    At no factor of the thrust do the commands explain half of the motion, as they do in most runs, and the
    residual is far above theirs: a boat that drifts without commands has neither.
    """
    if len(every) < FEWEST or np.median([one.explained for one in every]) < EXPLAINED:
        return []
    usual = np.median([one.rms for one in every])
    return [one for one in every if not (one.explained >= EXPLAINED or one.rms <= UNUSUAL * usual)]


def standardised(values: Array, errors: Array) -> tuple[Array, Array]:
    """Distances (..., n) of values (..., n) from their median in standard deviations, and the part (...) of
    these between runs: the one, at least ORDINARY, by which the median squared distance is that of
    chi-square, by bisection. errors: (n,).
    """
    square = (values - np.median(values, axis=-1, keepdims=True)) ** 2
    low = np.full((*values.shape[:-1], 1), ORDINARY**2)
    high = low + square.max(axis=-1, keepdims=True) / CHI2_MEDIAN
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        near = np.median(square / (errors**2 + middle), axis=-1, keepdims=True) < CHI2_MEDIAN
        low, high = np.where(near, low, middle), np.where(near, middle, high)
    return np.sqrt(square / (errors**2 + low)), np.sqrt(low[..., 0])


def without(run_set: RunSet, names: Collection[str]) -> RunSet:
    """The runs but those of these names."""
    kept = [k for k, name in enumerate(run_set.names) if name not in names]
    return replace(run_set.subset(kept), origin=()) if len(kept) < len(run_set.names) else run_set
