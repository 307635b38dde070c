"""Initial states at their best under given numbers: every window for itself."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

ENOUGH = 0.3  # chi2: a step that lowers it by less ends a fit
HOPELESS_SHARE = 5e-3  # of what is left above noise: the same for a hypothesis that is far from the data
LAST_DAMPING = 1.0  # damping beyond which a window that did not move any more is left


def settle(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, rounds: int
) -> tuple[Array, Array, Array]:
    """States (W, 6), prediction and residual at their best under a given x (p,), by Marquardt's steps.

    Windows that have nothing more to gain are not rolled out again; a Jacobian serves until its window moves.
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
        active &= (step * b).sum(axis=1) > 0.1 * ENOUGH
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
        active[lost[damping[lost] > LAST_DAMPING]] = False
        damping[won] = np.where(damping[won] < 0.01, 0.0, damping[won] / 10.0)
        damping[lost] = 10.0 * damping[lost] + 0.01
        moved = np.zeros(count, dtype=bool)
        moved[won] = True
    return states, base, residual


def losses(residual: Array) -> Array:
    """(W,) chi2 of each window's residuals (W, M), infinite where a rollout ran away."""
    with np.errstate(over="ignore"):
        return np.asarray((residual**2).sum(axis=1))


def enough(problem: Shooting, chi2: float) -> float:
    """Fall of chi2 that is worth a step: a small one counts only where the data are nearly explained."""
    return max(ENOUGH, HOPELESS_SHARE * (chi2 - 1.1 * problem.samples))


def _chosen(problem: Shooting, chosen: NDArray[np.bool_]) -> Shooting:
    return problem if chosen.all() else problem.part(chosen)


def _ridged(A: Array, damping: Array) -> Array:
    """(W, 6, 6) with Marquardt's share of the diagonal added."""
    diagonal = np.einsum("wii->wi", A) * (1e-11 + damping[:, None]) + 1e-12
    return np.asarray(A + diagonal[..., None] * np.eye(6))
