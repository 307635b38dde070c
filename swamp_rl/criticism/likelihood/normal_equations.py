"""Normal equations of windows, each with initial states of its own, which are eliminated."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.options import options
from swamp_rl.criticism.threads import divided

Array = NDArray[np.float64]
Products = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Normal:
    """Normal equations of every window, its six initial states eliminated (Schur complement).

    information: (W, p, p); gradient: (W, p); profile_chi2: (W,) chi2 minimised over the initial states, -2
    log of the profile likelihood but for a constant.
    """

    states_information: Array
    cross: Array
    states_gradient: Array
    information: Array
    gradient: Array
    profile_chi2: Array

    def shift(self, step: Array) -> Array:
        """(W, 6) change of the initial states that goes with a step of the parameters, (p,) or (W, p)."""
        by = self.cross @ step if step.ndim == 1 else (self.cross @ step[..., None])[..., 0]
        wanted = self.states_gradient - by
        return np.asarray(np.linalg.solve(self.states_information, wanted[..., None])[..., 0], dtype=float)


def products_of(states: Array, slopes: Array) -> Products:
    """Of Jacobians by initial states S (W, M, 6) and by parameters P (W, M, p): S'S, S'P and P'P."""
    transposed, by = np.swapaxes(states, 1, 2), np.swapaxes(slopes, 1, 2)
    cross, square = (np.empty((*one.shape[:2], slopes.shape[2])) for one in (transposed, by))

    def part(mine: slice) -> None:
        np.matmul(transposed[mine], slopes[mine], out=cross[mine])
        np.matmul(by[mine], slopes[mine], out=square[mine])

    divided(part, len(slopes), slopes.size // options().slope_share)
    return transposed @ states, cross, square


def normal_equations(
    states: Array,
    slopes: Array,
    residual: Array,
    damping: float | Array = 0.0,
    products: Products | None = None,
) -> Normal:
    """From Jacobians by initial states (W, M, 6) and by parameters (W, M, p), and residuals (W, M); products:
    of the Jacobians, where known.
    """
    A, C, square = products or products_of(states, slopes)
    ridge = 1e-11 * np.einsum("wii->wi", A) + 1e-12 + damping**2
    A = A + ridge[..., None] * np.eye(6)
    b = (np.swapaxes(states, 1, 2) @ residual[..., None])[..., 0]
    solved = np.linalg.solve(A, np.concatenate([C, b[..., None]], axis=2))
    across = np.swapaxes(C, 1, 2)
    by = np.swapaxes(slopes, 1, 2)
    information, gradient = np.empty_like(square), np.empty(square.shape[:2])

    def part(mine: slice) -> None:
        np.subtract(square[mine], across[mine] @ solved[mine, :, :-1], out=information[mine])
        along = (by[mine] @ residual[mine, :, None])[..., 0]
        gradient[mine] = along - (across[mine] @ solved[mine, :, -1:])[..., 0]

    divided(part, len(slopes), slopes.size // options().slope_share)
    profile_chi2 = (residual**2).sum(axis=1) - (b * solved[..., -1]).sum(axis=1)
    return Normal(A, C, b, information, gradient, profile_chi2)


@dataclass(frozen=True)
class Jacobians:
    """Jacobians of the standardised prediction by states (W, M, 6) and by parameters (W, M, p)."""

    by_state: Array
    by_x: Array

    def normal(self, residual: Array, damping: float | Array = 0.0) -> Normal:
        """The normal equations with residuals (W, M)."""
        return normal_equations(self.by_state, self.by_x, residual, damping, self._products)

    @cached_property
    def _products(self) -> Products:
        return products_of(self.by_state, self.by_x)
