"""Forces constant in short intervals, fitted together with the initial states of windows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.finite_differences import state_jacobian
from swamp_rl.criticism.likelihood.force_sensitivity import (
    AXES,
    ForceGrid,
    force_jacobian,
    inverse_correlation,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import (
    chosen_windows,
    losses,
    next_damping,
    state_reach,
)
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ForceFit:
    """Initial states (W, 6), track (W, T, 6), force (W, B, 3) [N, N, N m]."""

    states: Array
    track: Array
    force: Array


def fit_forces(
    problem: Shooting, hypothesis: Hypothesis, x: Array, grid: ForceGrid, sizes: tuple[float, ...]
) -> ForceFit:
    """The forces, constant in each interval, at least chi2; a Jacobian is kept until its window moves. sizes:
    (3,) standard deviations, in `force_scale`, of the Gauss-Markov process that is their prior.

    From the initial states that the data show: fitted without forces, those of a wrong model may lie where no
    force leads back, as beyond a speed of zero.
    """
    states = problem.initial_states().copy()
    track = problem.predict(hypothesis, x[None], states[None])[0]
    residual = problem.residuals(track)
    shape = (problem.windows.count, grid.count, AXES)
    alike = inverse_correlation(grid.count, grid.block * problem.dt, options().regression_time)
    prior = np.kron(alike, np.diag((np.array(sizes) * force_scale(problem.boat)) ** -2.0))
    force = np.zeros(shape)

    def chi2(residual: Array, force: Array) -> Array:
        """(W,) of the residuals and the prior."""
        flat = force.reshape(shape[0], -1)
        return losses(residual) + ((flat @ prior) * flat).sum(axis=1)

    damping = np.zeros(shape[0])
    moved = np.ones(shape[0], dtype=bool)
    by_state = np.empty((*residual.shape, 6))
    by_force = np.empty((*residual.shape, AXES * grid.count))
    for _ in range(options().force_rounds):
        if moved.any():
            part, where = chosen_windows(problem, moved), (hypothesis, x, states[moved])
            acceleration = force[moved] / grid.inertia
            by_state[moved] = state_jacobian(part, *where, track[moved], acceleration, grid.block)
            by_force[moved] = force_jacobian(part, *where, grid, (0, 1, 2), force[moved])
        normal = normal_equations(by_state, by_force, residual, damping[:, None] / state_reach(problem))
        H = normal.information + prior
        H = H + (damping[:, None] * np.einsum("wii->wi", H))[..., None] * np.eye(H.shape[1])
        g = normal.gradient - force.reshape(shape[0], -1) @ prior
        step = np.asarray(np.linalg.solve(H, g[..., None])[..., 0])
        if (step * g).sum(axis=1).max() < options().window_decrease:
            break
        shift = normal.shift(step)
        tried: Array = force + step.reshape(shape)
        acceleration = np.asarray(tried / grid.inertia)
        ahead = problem.predict(hypothesis, x[None], (states + shift)[None], acceleration, grid.block)[0]
        left = problem.residuals(ahead)
        moved = chi2(left, tried) < chi2(residual, force)
        states[moved] += shift[moved]
        force[moved], track[moved], residual[moved] = tried[moved], ahead[moved], left[moved]
        damping = next_damping(damping, moved, options().force_damping)
    return ForceFit(states, track, force)
