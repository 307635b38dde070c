"""Initial states of each window at least chi2, the parameters fixed."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.levenberg_marquardt import minimise_by_window
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def fit_states(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, rounds: int
) -> tuple[Array, Array, Array]:
    """States (W, 6), prediction and residual at least chi2 under x (p,)."""

    def evaluate(part: Shooting, states: Array) -> Array:
        return part.predict(hypothesis, x[None], states[None])[0]

    def linearise(part: Shooting, states: Array, base: Array, residual: Array) -> tuple[Array, Array]:
        slopes = part.state_jacobian(hypothesis, x, states, base)
        transposed = np.swapaxes(slopes, 1, 2)
        return transposed @ slopes, (transposed @ residual[..., None])[..., 0]

    found = minimise_by_window(problem, states, evaluate, linearise, rounds, options().last_damping)
    return found.u, found.prediction, found.residual


def min_decrease(problem: Shooting, chi2: float) -> float:
    """Fall of chi2 below which a fit ends; larger where the fit is far from the data."""
    above = chi2 - options().noise_chi2 * problem.samples
    return max(options().least_decrease, options().least_decrease_share * above)
