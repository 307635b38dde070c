"""Levenberg-Marquardt for many independent least-squares problems at once: one for each window."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]
Evaluate = Callable[[Shooting, Array], Array]
Linearise = Callable[[Shooting, Array, Array, Array], tuple[Array, Array]]


@dataclass(frozen=True)
class WindowFit:
    """Unknowns u (W, q) of each window at least chi2, prediction (W, T, 6), residual (W, M), and the
    information about u (W, q, q).
    """

    u: Array
    prediction: Array
    residual: Array
    information: Array


def minimise_by_window(
    problem: Shooting,
    u: Array,
    evaluate: Evaluate,
    linearise: Linearise,
    rounds: int,
    last_damping: float = np.inf,
) -> WindowFit:
    """The fit from u (W, q) with at most `rounds` steps.

    evaluate: prediction of some windows at their u; linearise: information (n, q, q) and gradient (n, q) of
    some windows at their u, prediction and residual, a Gaussian prior included; last_damping: that above
    which a window that did not improve is left. Converged windows are not simulated again; a linearisation
    is kept until its window moves.
    """
    count, size = u.shape
    u = u.copy()
    prediction = evaluate(problem, u)
    residual = problem.residuals(prediction)
    damping = np.zeros(count)
    A, b = np.zeros((count, size, size)), np.zeros((count, size))
    active = moved = np.ones(count, dtype=bool)
    least, factor = options().window_decrease, options().damping_factor
    first = options().first_damping
    for _ in range(rounds):
        if moved.any():
            part = _chosen(problem, moved)
            A[moved], b[moved] = linearise(part, u[moved], prediction[moved], residual[moved])
        step = np.linalg.solve(_ridged(A, damping), b[..., None])[..., 0]
        active &= (step * b).sum(axis=1) > least
        if not active.any():
            break
        part, tried = _chosen(problem, active), u[active] + step[active]
        reached = evaluate(part, tried)
        left = part.residuals(reached)
        better = losses(residual[active]) - losses(left) > 0.0
        place = np.flatnonzero(active)
        won, lost = place[better], place[~better]
        u[won], prediction[won], residual[won] = tried[better], reached[better], left[better]
        active = active.copy()
        active[lost[damping[lost] > last_damping]] = False
        damping[won] = np.where(damping[won] < first, 0.0, damping[won] / factor)
        damping[lost] = factor * damping[lost] + first
        moved = np.zeros(count, dtype=bool)
        moved[won] = True
    return WindowFit(u, prediction, residual, A)


def losses(residual: Array) -> Array:
    """(W,) chi2 of each window's residuals (W, M), infinite where a simulation diverged."""
    with np.errstate(over="ignore"):
        return np.asarray((residual**2).sum(axis=1))


def _chosen(problem: Shooting, chosen: NDArray[np.bool_]) -> Shooting:
    return problem if chosen.all() else problem.part(chosen)


def _ridged(A: Array, damping: Array) -> Array:
    """(W, q, q) with Marquardt's multiple of the diagonal added."""
    diagonal = np.einsum("wii->wi", A) * (1e-11 + damping[:, None]) + 1e-12
    return np.asarray(A + diagonal[..., None] * np.eye(A.shape[1]))
