"""Regression of the residual force on each variable, by simulation.

A force that is a function of a variable is a weighted sum of short pulses, whose sensitivities are computed
once, about a track that follows the data. Each pair of a force and a variable is judged on held-out runs.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.force_sensitivity import AXES
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.force_functions import (
    EARTH,
    EARTH_AXES,
    PLACE,
    ForceLikelihood,
    Pair,
    force_likelihood,
    pairs,
)
from swamp_rl.criticism.nuisance.process_noise import random_forces
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import CurvePoint, ResidualForce
from swamp_rl.criticism.selection.information_criterion import information_criterion
from swamp_rl.criticism.selection.model_selection import OTHERS

Array = NDArray[np.float64]

AXES_OF = {"surge": (0,), "sway": (1,), "yaw": (2,), "north": (0, 1), "east": (0, 1), EARTH: (0, 1)}


@dataclass(frozen=True)
class MarginalLikelihood:
    """chi2 marginalised over Gauss-Markov forces (process noise): information (W, 3 B, 3 B) and gradient (W,
    3 B) of a deterministic force; power: (3,) variance of the process noise [N2, N2, N2 m2]; left: -2 log
    likelihood but for a constant.
    """

    information: Array
    gradient: Array
    power: Array
    left: float


def marginal_likelihood(found: ForceLikelihood, known: Array) -> MarginalLikelihood:
    """Beside known forces (W, 3 B); the variance of the process noise at maximum likelihood."""
    H = found.information
    g = found.gradient - (H @ known[..., None])[..., 0]
    made = random_forces(H, g, found.block * found.dt, options().regression_time, found.scale)
    acceleration = (made.prior @ made.force[..., None])[..., 0]
    left = found.chi2 - float((known * (found.gradient + g)).sum()) - made.gain
    return MarginalLikelihood(
        np.asarray(made.prior - made.prior @ made.spread @ made.prior), acceleration, made.power, left
    )


@dataclass(frozen=True)
class HeldOutGain:
    """Fall of chi2 on held-out folds, predicted force (W, 3 B), prior standard deviation [N] of weights."""

    gain: float
    predicted_force: Array
    deviation: float


def held_out_gain(
    pair: Pair, marginal: MarginalLikelihood, folds: Sequence[NDArray[np.int64]], thrust: float
) -> HeldOutGain:
    """The gain of a pair, of several foldings and priors the greatest: a variable that varies in one run only
    is identifiable from the rest of that run. thrust: the boat's [N].
    """
    across = np.swapaxes(pair.design, 1, 2)
    H, g = across @ marginal.information @ pair.design, (across @ marginal.gradient[..., None])[..., 0]
    best = HeldOutGain(-np.inf, np.zeros(marginal.gradient.shape), 0.0)
    for fold, deviation in itertools.product(folds, np.multiply(thrust, options().regression_priors)):
        weights = np.empty(g.shape)
        prior = np.eye(g.shape[1]) / deviation**2
        for part in np.unique(fold):
            others = fold != part
            weights[~others] = np.linalg.solve(H[others].sum(axis=0) + prior, g[others].sum(axis=0))
        gain = float((2.0 * g * weights).sum() - np.einsum("wij,wi,wj->", H, weights, weights))
        if gain > best.gain:
            best = HeldOutGain(gain, (pair.design @ weights[..., None])[..., 0], deviation)
    return best


def curves(pair: Pair, information: Array, gradient: Array, deviation: float) -> list[list[CurvePoint]]:
    """The functions of a pair estimated from all windows, each in the order of its variable; information (W,
    3 B, 3 B) and gradient (W, 3 B): of a force beside the process noise.
    """
    across = np.swapaxes(pair.design, 1, 2)
    H = (across @ information @ pair.design).sum(axis=0)
    covariance = np.linalg.inv(H + np.eye(len(H)) / deviation**2)
    weights = covariance @ (across @ gradient[..., None]).sum(axis=0)[:, 0]
    points = [
        CurvePoint(at=float(at), force=float(force), standard_error=float(np.sqrt(variance)))
        for at, force, variance in zip(np.concatenate(pair.knots), weights, np.diag(covariance), strict=True)
    ]
    ends = np.cumsum([0, *(len(knots) for knots in pair.knots)])
    return [
        sorted(points[low:high], key=lambda one: one.at) for low, high in itertools.pairwise(ends.tolist())
    ]


def select_functions(found: ForceLikelihood) -> tuple[float, list[ResidualForce]]:
    """The -2 log likelihood at the end, see `MarginalLikelihood`, and the functions by forward selection on
    held-out gain, sorted by explained variance. Empty where none is significant.
    """
    every = pairs(found)
    known = np.zeros(found.gradient.shape)
    marginal = first = marginal_likelihood(found, known)
    listed = list[ResidualForce]()
    while len(listed) < options().listed_functions and every:
        judged = [(held_out_gain(pair, marginal, found.folds, float(found.scale[0])), pair) for pair in every]
        judged.sort(key=lambda one: -one[0].gain)
        most, best = judged[0]
        if most.gain < options().regression_gain:
            break
        known = known + most.predicted_force
        marginal = marginal_likelihood(found, known)
        back = marginal.gradient + (marginal.information @ most.predicted_force[..., None])[..., 0]
        least = most.gain - 1e-9 if listed else options().regression_tie * most.gain
        every = [one for one in every if one is not best]
        for one, pair in [one for one in judged if one[0].gain > least]:
            share = power_share(pair, one.predicted_force, marginal, first)
            listed += [
                ResidualForce(force=force, variable=variable, explained=share, gain=one.gain, curve=curve)
                for (force, variable), curve in zip(
                    _labels(pair), curves(pair, marginal.information, back, one.deviation), strict=True
                )
            ]
    apart: dict[tuple[str, str], ResidualForce] = {}
    for function in listed:
        apart.setdefault((function.force, function.variable), function)
    return marginal.left, sorted(
        list(apart.values())[: options().listed_functions], key=lambda one: -one.explained
    )


def power_share(
    pair: Pair, predicted_force: Array, marginal: MarginalLikelihood, first: MarginalLikelihood
) -> float:
    """Share of variance along the pair's axes that its force (W, 3 B) explains beside the process noise."""
    axes = list(AXES_OF.get(pair.force, range(AXES)))
    explained = (predicted_force**2).reshape(-1, AXES).mean(axis=0)[axes] / first.power[axes]
    left = marginal.power[axes] / first.power[axes]
    return float(explained.sum() / (explained + left).sum())


def _labels(pair: Pair) -> list[tuple[str, str]]:
    if pair.force == EARTH:
        return [(name, f"{PLACE} {name}") for name in EARTH_AXES]
    return [(pair.force, pair.variable)]


def without_process_noise(run_set: RunSet) -> RunSet:
    """The runs with white noise where all channels have a Gauss-Markov part: the residual force."""
    if run_set.gauss_markov is not None and (run_set.gauss_markov[OTHERS, 0] > 0).any():
        return replace(run_set, gauss_markov=None)
    return run_set


def residual_force_functions(
    run_set: RunSet, weight: Array, every: Sequence[tuple[Hypothesis, Array]]
) -> list[ResidualForce]:
    """The residual force as functions, under the hypothesis at (p,) of least information criterion."""
    run_set = without_process_noise(run_set)
    criterion = information_criterion(run_set, float((weight > 0).sum()))
    results = []
    for hypothesis, x in every:
        left, listed = select_functions(force_likelihood(run_set, weight, hypothesis, x))
        results.append((left + criterion.charge(hypothesis), hypothesis, listed))
    _, hypothesis, listed = min(results, key=lambda one: one[0])
    beside = [instance.label for instance in hypothesis.instances]
    return [one.model_copy(update={"beside": beside}) for one in listed]
