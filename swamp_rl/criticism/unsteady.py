"""Process noise against measurement noise: the likelihoods of Gauss-Markov forces and position errors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.pushes import AXES, push_normal, pushes_of
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

REACH, LEAST_POWER, ROUNDS = 5.0, 1e-4, 12  # N and N2, of forces at first and at least; times it is told anew
PIECE, MOST_PIECES = 2.0, 60  # s that a force is constant in, and how many of them a window has at most
LASTING = (2.0, 8.0, 32.0)  # s that forces hang together for, of which the likeliest is taken


@dataclass(frozen=True)
class RandomForces:
    """Forces that come and go, surge, sway and yaw in the B pieces of W windows: a first-order Gauss-Markov
    process of the likeliest power.

    prior (3 B, 3 B): inverse of their covariance; spread (W, 3 B, 3 B): covariance given the data; force
    (W, 3 B): expected [N, N m]; power (3,): variance; gain: twice the log-likelihood over that of none.
    """

    prior: Array
    spread: Array
    force: Array
    power: Array
    gain: float


def random_forces(information: Array, gradient: Array, piece: float, lasting: float) -> RandomForces:
    """From chi2 as a function of forces, initial states eliminated: information (W, 3 B, 3 B) and gradient
    (W, 3 B); pieces of `piece` s. The power by expectation and maximisation (Dempster, Laird and Rubin 1977),
    each piece by itself.
    """
    windows, pieces = len(gradient), gradient.shape[1] // AXES
    apart = np.abs(np.subtract.outer(np.arange(pieces), np.arange(pieces))) * piece
    alike = np.linalg.inv(np.exp(-apart / lasting))
    power: Array = np.full(AXES, REACH**2)
    for _ in range(ROUNDS):
        prior = np.kron(alike, np.diag(1.0 / power))
        spread = np.linalg.inv(information + prior)
        force = (spread @ gradient[..., None])[..., 0]
        squares: Array = force**2 + np.einsum("wii->wi", spread)
        told, power = power, np.maximum(squares.reshape(-1, AXES).mean(axis=0), LEAST_POWER)
    volume = np.linalg.slogdet(spread)[1].sum() + windows * np.linalg.slogdet(prior)[1]
    return RandomForces(np.asarray(prior), spread, force, told, float((gradient * force).sum() + volume))


def gain_of_forces(problem: Shooting, at: Fit) -> float:
    """Twice the log-likelihood that forces which come and go add to a fit, its numbers as they are."""
    pushes = pushes_of(problem, max(PIECE, (problem.windows.rows - 1) * problem.dt / MOST_PIECES))
    where = (problem, at.hypothesis, at.x, at.states, pushes, (0, 1, 2))
    normal = push_normal(*where, at.states_jacobian, at.residual)
    piece = pushes.block * problem.dt
    return max(random_forces(normal.information, normal.gradient, piece, lasting).gain for lasting in LASTING)


def gain_of_wandering(white: Fit, aware: Shooting, at: Fit) -> float:
    """Twice the log-likelihood that errors which wander add to a fit under white noise; at: the fit to the
    comparison that knows of them.
    """
    if aware.filter is None:
        return 0.0
    scale = aware.filter.scale
    return white.chi2 - at.chi2 + 2.0 * float(np.log(scale[scale > 0.0]).sum())
