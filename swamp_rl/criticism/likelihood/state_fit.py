"""Initial states of each window at least chi2, the parameters fixed."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def fit_states(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, rounds: int
) -> tuple[Array, Array, Array]:
    """States (W, 6), prediction and residual at least chi2 under x (p,), by Levenberg-Marquardt.

    Converged windows are not simulated again; a Jacobian is kept until its window moves.
    """
    count = len(states)
    states = states.copy()
    base = problem.predict(hypothesis, x[None], states[None])[0]
    residual = problem.residuals(base)
    damping = np.zeros(count)
    A, b = np.zeros((count, 6, 6)), np.zeros((count, 6))
    active = moved = np.ones(count, dtype=bool)
    for _ in range(rounds):
        if moved.any():
            slopes = _chosen(problem, moved).state_jacobian(hypothesis, x, states[moved], base[moved])
            transposed = np.swapaxes(slopes, 1, 2)
            A[moved], b[moved] = transposed @ slopes, (transposed @ residual[moved, :, None])[..., 0]
        step = np.linalg.solve(_ridged(A, damping), b[..., None])[..., 0]
        active &= (step * b).sum(axis=1) > options().window_decrease
        if not active.any():
            break
        part, tried = _chosen(problem, active), states[active] + step[active]
        prediction = part.predict(hypothesis, x[None], tried[None])[0]
        left = part.residuals(prediction)
        gain = losses(residual[active]) - losses(left)
        better = gain > 0.0
        place = np.flatnonzero(active)
        won, lost = place[better], place[~better]
        states[won], base[won], residual[won] = tried[better], prediction[better], left[better]
        active = active.copy()
        active[lost[damping[lost] > options().last_damping]] = False
        damping[won] = np.where(
            damping[won] < options().first_damping, 0.0, damping[won] / options().damping_factor
        )
        damping[lost] = options().damping_factor * damping[lost] + options().first_damping
        moved = np.zeros(count, dtype=bool)
        moved[won] = True
    return states, base, residual


def losses(residual: Array) -> Array:
    """(W,) chi2 of each window's residuals (W, M), infinite where a simulation diverged."""
    with np.errstate(over="ignore"):
        return np.asarray((residual**2).sum(axis=1))


def min_decrease(problem: Shooting, chi2: float) -> float:
    """Fall of chi2 below which a fit ends; larger where the fit is far from the data."""
    return max(
        options().least_decrease,
        options().least_decrease_share * (chi2 - options().noise_chi2 * problem.samples),
    )


def _chosen(problem: Shooting, chosen: NDArray[np.bool_]) -> Shooting:
    return problem if chosen.all() else problem.part(chosen)


def _ridged(A: Array, damping: Array) -> Array:
    """(W, 6, 6) with Marquardt's multiple of the diagonal added."""
    diagonal = np.einsum("wii->wi", A) * (1e-11 + damping[:, None]) + 1e-12
    return np.asarray(A + diagonal[..., None] * np.eye(6))
