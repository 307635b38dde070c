"""Process noise against measurement noise: the likelihoods of Gauss-Markov forces and position errors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.force_sensitivity import AXES, force_grid, force_normal_equations
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RandomForces:
    """First-order Gauss-Markov forces of surge, sway and yaw in the B intervals of W windows, of the most
    likely power.

    prior (3 B, 3 B): inverse of their covariance; spread (W, 3 B, 3 B): covariance given the data; force (W,
    3 B): expected [N, N m]; power (3,): variance; gain: 2 log likelihood ratio to no forces.
    """

    prior: Array
    spread: Array
    force: Array
    power: Array
    gain: float


def random_forces(
    information: Array, gradient: Array, piece: float, correlation_time: float, scale: Array
) -> RandomForces:
    """From chi2 as a function of forces, initial states eliminated: information (W, 3 B, 3 B) and gradient
    (W, 3 B); intervals of `piece` s, correlation time [s], scale: `force_scale`. The power by
    expectation-maximisation (Dempster, Laird and Rubin 1977), one for each axis.
    """
    windows, pieces = len(gradient), gradient.shape[1] // AXES
    apart = np.abs(np.subtract.outer(np.arange(pieces), np.arange(pieces))) * piece
    alike = np.linalg.inv(np.exp(-apart / correlation_time))
    power: Array = (np.array(options().process_reach) * scale) ** 2
    for _ in range(options().process_rounds):
        prior = np.kron(alike, np.diag(1.0 / power))
        spread = np.linalg.inv(information + prior)
        force = (spread @ gradient[..., None])[..., 0]
        squares: Array = force**2 + np.einsum("wii->wi", spread)
        power_before, power = (
            power,
            np.maximum(
                squares.reshape(-1, AXES).mean(axis=0), (np.array(options().process_least) * scale) ** 2
            ),
        )
    volume = np.linalg.slogdet(spread)[1].sum() + windows * np.linalg.slogdet(prior)[1]
    return RandomForces(
        np.asarray(prior), spread, force, power_before, float((gradient * force).sum() + volume)
    )


def process_noise_gain(problem: Shooting, at: Fit) -> float:
    """2 log likelihood ratio of Gauss-Markov forces beside a fit, its parameters fixed."""
    grid = force_grid(
        problem,
        max(options().process_piece, (problem.windows.rows - 1) * problem.dt / options().process_pieces),
    )
    where = (problem, at.hypothesis, at.x, at.states, grid, (0, 1, 2))
    normal = force_normal_equations(*where, at.states_jacobian, at.residual)
    piece, scale = grid.block * problem.dt, force_scale(problem.boat)
    return max(
        random_forces(normal.information, normal.gradient, piece, correlation_time, scale).gain
        for correlation_time in options().process_times
    )


def measurement_noise_gain(white: Fit, aware: Shooting, at: Fit) -> float:
    """2 log likelihood ratio of Gauss-Markov measurement noise to white noise; at: the fit under the
    former.
    """
    if aware.filter is None:
        return 0.0
    scale = aware.filter.scale
    return white.chi2 - at.chi2 + 2.0 * float(np.log(scale[scale > 0.0]).sum())
