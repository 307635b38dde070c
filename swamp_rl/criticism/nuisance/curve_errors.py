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
from swamp_rl.criticism.likelihood.force_sensitivity import AXES
from swamp_rl.criticism.likelihood.output_error import inverse
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.force_functions import (
    EARTH,
    PLACE,
    ForceLikelihood,
    force_likelihood,
    pairs,
)
from swamp_rl.criticism.nuisance.process_noise import inverse_correlation
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

OF_THE_EARTH = ("north", "east", EARTH)
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
        if pair.force not in OF_THE_EARTH and not pair.variable.startswith(NOT_A_CURVE)
    ]
    return np.concatenate(made, axis=2)


@dataclass(frozen=True)
class Quadratic:
    """chi2 as a function of U common numbers c and forces e (W, 3 B) of each window: information (U, U),
    gradient (U,) of c; cross (W, U, 3 B); of_forces (W, 3 B, 3 B) and gradient_of_forces (W, 3 B) of e.

    Common numbers: steps of the parameters, then weights of the curves. precision: (p,) of the parameters'
    prior; alike: (B, B) inverse correlation of e.
    """

    chi2: float
    information: Array
    gradient: Array
    cross: Array
    of_forces: Array
    gradient_of_forces: Array
    precision: Array
    alike: Array


def quadratic(found: ForceLikelihood, curves: Array, away: Array, precision: Array) -> Quadratic:
    """With weights of the curves (W, 3 B, K); away: (p,) of the parameters from the mean of their prior;
    precision: (p,).
    """
    p = found.parameters
    H, g = found.information[:, p:, p:], found.gradient[:, p:]
    cross = np.concatenate([found.information[:, :p, p:], np.swapaxes(H @ curves, 1, 2)], axis=1)
    by_curves = np.einsum("wuf,wfk->uk", cross, curves, optimize=True)
    information = np.zeros((len(by_curves), len(by_curves)))
    information[:, p:] = by_curves
    information[p:, :p] = by_curves[:p].T
    information[:p, :p] = found.information[:, :p, :p].sum(axis=0)
    of_steps = found.gradient[:, :p].sum(axis=0) - precision * away
    gradient = np.concatenate([of_steps, np.einsum("wfk,wf->k", curves, g)])
    alike = inverse_correlation(g.shape[1] // AXES, found.block * found.dt, options().regression_time)
    chi2 = found.chi2 + float(precision @ away**2)
    return Quadratic(chi2, information, gradient, cross, H, g, precision, alike)


@dataclass(frozen=True)
class Marginal:
    """deviance: -2 log likelihood but for a constant, the weights and the forces marginalised, at the best
    parameters; parameter_variances: (p,) of those parameters; power (3,) and variance: expected squares of
    the forces of each axis and of a weight.
    """

    deviance: float
    parameter_variances: Array
    power: Array
    variance: float


def marginal(of: Quadratic, power: Array, variance: float) -> Marginal:
    """At the variances (3,) of the Gauss-Markov forces and of the weights."""
    p, pieces = len(of.precision), len(of.alike)
    weights = len(of.gradient) - p
    prior, own = np.kron(of.alike, np.diag(1.0 / power)), of.gradient_of_forces
    spread = np.linalg.inv(of.of_forces + prior)
    gain = of.cross @ spread
    information = of.information - np.einsum("wuf,wvf->uv", gain, of.cross, optimize=True)
    information += np.diag(np.concatenate([of.precision, np.full(weights, 1.0 / variance)]))
    gradient = of.gradient - np.einsum("wuf,wf->u", gain, own)
    covariance, determinant = _covariance(information, p)
    common = covariance @ gradient
    explained = float(common @ gradient + np.einsum("wf,wfg,wg->", own, spread, own, optimize=True))
    volume = -np.linalg.slogdet(spread)[1].sum() - len(own) * np.linalg.slogdet(prior)[1]
    volume += determinant + weights * np.log(variance)
    force = (spread @ (own - common @ of.cross)[..., None])[..., 0]
    doubt = (spread + np.swapaxes(gain, 1, 2) @ covariance @ gain).sum(axis=0)
    squares = (doubt + force.T @ force).reshape(pieces, AXES, pieces, AXES)
    return Marginal(
        of.chi2 - explained + float(volume),
        np.diag(covariance)[:p],
        np.einsum("bc,baca->a", of.alike, squares) / (len(own) * pieces),
        float((common[p:] ** 2 + np.diag(covariance)[p:]).mean()),
    )


def _covariance(information: Array, p: int) -> tuple[Array, float]:
    """Inverse of an information matrix (U, U), and the logarithm of the determinant of its block of all but
    the first p numbers, which has a prior; infinite where a simulation diverged.
    """
    if not np.isfinite(information).all():
        return np.full_like(information, np.inf), np.inf
    across, ridge = information[:p, p:], np.diag(1e-12 * np.diag(information)[p:])
    factor = cho_factor(information[p:, p:] + ridge, lower=True)
    own = cho_solve(factor, np.eye(len(ridge)))
    by = across @ own
    covariance = np.empty_like(information)
    covariance[:p, :p] = inverse(information[:p, :p] - by @ across.T)
    covariance[:p, p:] = -covariance[:p, :p] @ by
    covariance[p:, :p] = covariance[:p, p:].T
    covariance[p:, p:] = own - by.T @ covariance[:p, p:]
    return covariance, 2.0 * float(np.log(np.diag(factor[0])).sum())


def most_likely(of: Quadratic, scale: Array) -> Marginal:
    """At the most likely variances, by expectation-maximisation (Dempster, Laird and Rubin 1977); scale:
    `force_scale`.
    """
    force, weight = options().curve_errors_begin
    at = marginal(of, (force * scale) ** 2, weight**2)
    least = (np.array(options().process_least) * scale) ** 2
    for _ in range(options().process_rounds):
        at = marginal(of, np.maximum(at.power, least), at.variance)
    return at
