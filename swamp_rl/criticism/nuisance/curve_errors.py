"""Likelihood of a hypothesis beside errors of the model's curves (Kennedy and O'Hagan, Bayesian calibration
of computer models, J. R. Stat. Soc. B 63, 2001).

The curve of a hull's or thruster's force is wrong by a function of the motion and the commands. Such an error
repeats with the manoeuvre: it is the same in every window, and turns with the hull. It is estimated beside a
Gauss-Markov force of each window, both as random effects.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.force_sensitivity import AXES, inverse_correlation
from swamp_rl.criticism.likelihood.output_error import inverse
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.force_functions import (
    EARTH,
    EARTH_AXES,
    PLACE,
    ForceLikelihood,
    force_likelihood,
    pairs,
)
from swamp_rl.criticism.nuisance.process_noise import expected_power, likeliest_variances
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

NOT_A_CURVE = ("time", "heading", PLACE)


def beside_curve_errors(run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array) -> "Marginal":
    """The likelihood of a hypothesis with the errors of curves and the Gauss-Markov forces marginalised, at
    their most likely variances; its parameters from x (p,) by one Newton step. weight: (R, T, 6) of the
    measurement noise.
    """
    found = force_likelihood(replace(run_set, gauss_markov=None), weight, hypothesis, x, steps=True)
    mean, precision = hypothesis.prior()
    return most_likely(quadratic(found, curves_in_error(found), x - mean, precision), found.scale)


def curves_in_error(found: ForceLikelihood) -> Array:
    """(W, 3 B, K) forces by weights of unit variance: surge, sway, yaw and thrusts as functions of the motion
    and the commands, in the size of the boat's forces.
    """
    made = [
        pair.design * found.scale[AXES - 1 if pair.force == "yaw" else 0]
        for pair in pairs(found)
        if pair.force not in (*EARTH_AXES, EARTH) and not pair.variable.startswith(NOT_A_CURVE)
    ]
    return np.concatenate(made, axis=2)


@dataclass(frozen=True)
class Quadratic:
    """chi2 as a function of U common numbers c and forces e (W, 3 B) of each window: information (p, p) of
    the parameters, gradient (U,) of c; cross (W, U, 3 B); of_forces (W, 3 B, 3 B) and gradient_of_forces (W,
    3 B) of e.

    Common numbers: steps of the parameters, then weights of the curves (W, 3 B, K). precision: (p,) of the
    parameters' prior; alike: (B, B) inverse correlation of e.
    """

    chi2: float
    information: Array
    gradient: Array
    cross: Array
    of_forces: Array
    gradient_of_forces: Array
    curves: Array
    precision: Array
    alike: Array


def quadratic(found: ForceLikelihood, curves: Array, away: Array, precision: Array) -> Quadratic:
    """With weights of the curves (W, 3 B, K); away: (p,) of the parameters from the mean of their prior;
    precision: (p,).
    """
    p = found.parameters
    H, g = found.information[:, p:, p:], found.gradient[:, p:]
    cross = np.concatenate([found.information[:, :p, p:], np.swapaxes(H @ curves, 1, 2)], axis=1)
    information = found.information[:, :p, :p].sum(axis=0)
    of_steps = found.gradient[:, :p].sum(axis=0) - precision * away
    gradient = np.concatenate([of_steps, np.einsum("wfk,wf->k", curves, g)])
    alike = inverse_correlation(g.shape[1] // AXES, found.block * found.dt, options().regression_time)
    chi2 = found.chi2 + float(precision @ away**2)
    return Quadratic(chi2, information, gradient, cross, H, g, curves, precision, alike)


@dataclass(frozen=True)
class Marginal:
    """deviance: -2 log likelihood but for a constant, the weights and the forces marginalised, at the best
    parameters; gradient: (4,) of it by the logarithms of the variances; parameter_variances: (p,) of those
    parameters.
    """

    deviance: float
    gradient: Array
    parameter_variances: Array


def marginal(of: Quadratic, variances: Array) -> Marginal:
    """At the variances (4,): of the Gauss-Markov forces of each axis, and of the weights."""
    p, windows, pieces = len(of.precision), len(of.gradient_of_forces), len(of.alike)
    weights, (*power, variance) = len(of.gradient) - p, variances
    prior, own = np.kron(of.alike, np.diag(1.0 / np.array(power))), of.gradient_of_forces
    spread = np.linalg.inv(of.of_forces + prior)
    gain = of.cross @ spread
    # H - H S H = H S P of the forces' information H, spread S and prior P, without a difference
    by_weights = np.einsum("wuf,wfk->uk", gain, prior @ of.curves, optimize=True)
    of_weights = 0.5 * (by_weights[p:] + by_weights[p:].T) + np.eye(weights) / variance
    of_steps = of.information - np.einsum("wif,wjf->ij", gain[:, :p], of.cross[:, :p], optimize=True)
    of_steps += np.diag(of.precision)
    gradient = of.gradient - np.einsum("wuf,wf->u", gain, own)
    of_parameters, of_weights, by, determinant = _covariances(of_steps, by_weights[:p], of_weights)
    common = np.empty_like(gradient)
    common[:p] = of_parameters @ (gradient[:p] - by @ gradient[p:])
    common[p:] = of_weights @ gradient[p:] - by.T @ common[:p]
    explained = float(common @ gradient + np.einsum("wf,wfg,wg->", own, spread, own, optimize=True))
    volume = -np.linalg.slogdet(spread)[1].sum() - windows * np.linalg.slogdet(prior)[1]
    volume += determinant + weights * np.log(variance)
    force = (spread @ (own - common @ of.cross)[..., None])[..., 0]
    doubt = spread + np.swapaxes(gain[:, p:], 1, 2) @ of_weights @ gain[:, p:]
    expected = expected_power(doubt.sum(axis=0) + force.T @ force, of.alike, windows)
    of_weight = float((common[p:] ** 2 + np.diag(of_weights)).sum())
    slopes = np.append(windows * pieces * (1.0 - expected / power), weights - of_weight / variance)
    return Marginal(of.chi2 - explained + float(volume), slopes, np.diag(of_parameters))


def _covariances(of_steps: Array, across: Array, of_weights: Array) -> tuple[Array, Array, Array, float]:
    """From an information matrix in blocks, of parameters (p, p), across (p, K) and of weights (K, K):
    covariance of the parameters; of the weights beside known parameters; the change (p, K) of the weights by
    minus a parameter; logarithm of the determinant of the weights' information. Infinite where a simulation
    diverged.
    """
    if not all(np.isfinite(block).all() for block in (of_steps, across, of_weights)):
        return np.full_like(of_steps, np.inf), of_weights, across, np.inf
    factor = cho_factor(of_weights, lower=True)
    covariance = cho_solve(factor, np.eye(len(of_weights)))
    by = across @ covariance
    determinant = 2.0 * float(np.log(np.diag(factor[0])).sum())
    return inverse(of_steps - by @ across.T), covariance, by, determinant


def most_likely(of: Quadratic, scale: Array) -> Marginal:
    """At the most likely variances; scale: `force_scale`."""
    force, weight = options().curve_errors_begin
    begin = np.append(force * scale, weight)
    least = np.append(np.array(options().process_least) * scale, options().curve_errors_least)

    def deviance(variances: Array) -> tuple[float, Array]:
        at = marginal(of, variances)
        return at.deviance, at.gradient

    most = options().process_most * np.append(scale, 1.0)
    return marginal(of, likeliest_variances(deviance, begin**2, least**2, most**2))
