"""Output error by Gauss and Newton: parameters shared by all windows, an initial state for each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

ENOUGH = 0.3  # a step that lowers chi2 by less ends the fit
DAMPINGS = (0.0, 1.0, 4.0, 16.0, 64.0)  # steps tried are shorter than one reach (below) over this
STRAY, ROUNDS = 1.35, 6  # times the median loss that marks a stray window, steps it is given of its own
WORSE = 10.0  # chi2 by which a step makes a window worse before it is given steps of its own
STATE_REACH = np.array([0.5, 0.5, 0.2, 0.2, 0.2, 0.2])  # m, m, rad, m/s, m/s, rad/s


@dataclass(frozen=True)
class Normal:
    """Normal equations of every window, its six initial states eliminated (Schur complement).

    information: (W, p, p); gradient: (W, p); free: (W,) chi2 that no change of initial states removes.
    """

    states_information: Array
    cross: Array
    states_gradient: Array
    information: Array
    gradient: Array
    free: Array

    def shift(self, step: Array) -> Array:
        """(W, 6) change of the initial states that goes with a step (p,) of the parameters."""
        wanted = self.states_gradient - self.cross @ step
        return np.asarray(np.linalg.solve(self.states_information, wanted[..., None])[..., 0], dtype=float)


def normal_equations(states: Array, slopes: Array, residual: Array, damping: float | Array = 0.0) -> Normal:
    """From Jacobians by initial states (W, M, 6) and by parameters (W, M, p), and residuals (W, M)."""
    transposed = np.swapaxes(states, 1, 2)
    A = transposed @ states
    ridge = 1e-11 * np.einsum("wii->wi", A) + 1e-12 + (damping / STATE_REACH) ** 2
    A = A + ridge[..., None] * np.eye(6)
    C = transposed @ slopes
    b = (transposed @ residual[..., None])[..., 0]
    solved = np.linalg.solve(A, np.concatenate([C, b[..., None]], axis=2))
    across = np.swapaxes(C, 1, 2)
    by = np.swapaxes(slopes, 1, 2)
    information = by @ slopes - across @ solved[..., :-1]
    gradient = (by @ residual[..., None])[..., 0] - (across @ solved[..., -1:])[..., 0]
    free = (residual**2).sum(axis=1) - (b * solved[..., -1]).sum(axis=1)
    return Normal(A, C, b, information, gradient, free)


@dataclass(frozen=True)
class Fit:
    """A hypothesis at its best on some windows.

    x: (p,); states: (W, 6); residual: (W, M) in standard deviations; loss: (W,) chi2 of each window;
    normal: the equations there; penalty: of the prior; states_jacobian: (W, M, 6).
    """

    hypothesis: Hypothesis
    x: Array
    states: Array
    residual: Array
    loss: Array
    normal: Normal
    penalty: float
    states_jacobian: Array
    steps: int

    @property
    def chi2(self) -> float:
        """Sum of squared standardised residuals, prior included."""
        return float(self.loss.sum()) + self.penalty

    @property
    def covariance(self) -> Array:
        """(p, p) of x, for white noise of the estimated size."""
        _, precision = self.hypothesis.prior()
        return inverse(self.normal.information.sum(axis=0) + np.diag(precision))


def inverse(H: Array) -> Array:
    """Inverse of an information matrix (p, p), scaled; directions without information get a huge variance."""
    if not len(H) or not np.isfinite(H).all():
        return np.full_like(H, np.inf)
    scale = np.sqrt(np.maximum(np.diag(H), 1e-30))
    values, vectors = np.linalg.eigh(H / np.outer(scale, scale))
    return (vectors / np.maximum(values, 1e-12)) @ vectors.T / np.outer(scale, scale)


def prior_penalty(hypothesis: Hypothesis, x: Array) -> float:
    """Squared distance of x from its prior, in standard deviations."""
    mean, precision = hypothesis.prior()
    return float(precision @ (x - mean) ** 2)


def bounded_step(H: Array, g: Array, x: Array, low: Array, high: Array) -> Array:
    """Newton's step (p,) for information H and gradient g, along the bounds where it would leave them."""
    step = np.zeros(len(x))
    if not (np.isfinite(H).all() and np.isfinite(g).all()):  # a rollout has run away
        return step
    free = np.ones(len(x), dtype=bool)
    while free.any():
        rest = g - H @ np.where(free, 0.0, step)
        scale = np.sqrt(np.maximum(np.diag(H)[free], 1e-30))
        scaled = H[np.ix_(free, free)] / np.outer(scale, scale)
        step[free] = np.linalg.lstsq(scaled, rest[free] / scale, rcond=1e-12)[0] / scale
        beyond = free & ((x + step > high) | (x + step < low))
        if not beyond.any():
            break
        step[beyond] = np.clip(x + step, low, high)[beyond] - x[beyond]
        free &= ~beyond
    return step


def settle(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, rounds: int
) -> tuple[Array, Array, Array]:
    """States (W, 6), prediction and residual at their best under a given x (p,): every window for itself."""
    states = states.copy()
    base = problem.predict(hypothesis, x[None], states[None])[0]
    residual = problem.residuals(base)
    damping = np.zeros(len(states))
    for _ in range(rounds):
        by_state = problem.state_jacobian(hypothesis, x, states, base)
        none = np.zeros((*residual.shape, 0))
        tried = states + normal_equations(by_state, none, residual, damping[:, None]).shift(np.zeros(0))
        prediction = problem.predict(hypothesis, x[None], tried[None])[0]
        left = problem.residuals(prediction)
        better = (left**2).sum(axis=1) < (residual**2).sum(axis=1)
        states[better], base[better], residual[better] = tried[better], prediction[better], left[better]
        damping = np.where(better, damping / 3.0, 4.0 * damping + 1.0)
    return states, base, residual


def stray_windows(problem: Shooting, residual: Array) -> NDArray[np.bool_]:
    """(W,) windows that fit far worse than the others: their initial state went astray."""
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)), 1)
    share = (residual**2).sum(axis=1) / seen
    stray = share > STRAY * np.median(share)
    return stray if stray.sum() <= len(stray) // 3 else np.zeros_like(stray)


def fit(problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, steps: int = 8) -> Fit:
    """The hypothesis fitted from x (p,) and states (W, 6), in at most `steps` steps (Levenberg,
    Marquardt).
    """
    x, states = np.array(x, dtype=float), np.array(states, dtype=float)
    low, high = hypothesis.bounds()
    mean, precision = hypothesis.prior()
    reach = np.array([spec.scale for spec in hypothesis.specs])
    base = problem.predict(hypothesis, x[None], states[None])[0]
    residual = problem.residuals(base)
    start = 0
    for taken in range(steps + 1):
        by_state = problem.state_jacobian(hypothesis, x, states, base)
        by_x = problem.parameter_jacobian(hypothesis, x, states, base)
        here = Fit(
            hypothesis,
            x,
            states,
            residual,
            (residual**2).sum(axis=1),
            normal_equations(by_state, by_x, residual),
            prior_penalty(hypothesis, x),
            by_state,
            taken,
        )
        if taken == steps:
            break
        gain = 0.0
        for number in range(start, len(DAMPINGS)):
            damping = DAMPINGS[number]
            normal = normal_equations(by_state, by_x, residual, damping) if damping else here.normal
            H = normal.information.sum(axis=0) + np.diag(precision + len(states) * (damping / reach) ** 2)
            step = bounded_step(H, normal.gradient.sum(axis=0) - precision * (x - mean), x, low, high)
            moved = states + normal.shift(step)
            prediction = problem.predict(hypothesis, (x + step)[None], moved[None])[0]
            left = problem.residuals(prediction)
            worse = (left**2).sum(axis=1) > here.loss + WORSE
            if worse.any() and worse.sum() <= len(worse) // 3:
                found = settle(problem.part(worse), hypothesis, x + step, moved[worse], ROUNDS)
                moved[worse], prediction[worse], left[worse] = found
            total = float((left**2).sum()) + prior_penalty(hypothesis, x + step)
            if total < here.chi2:
                gain = here.chi2 - total
                start = max(0, number - 2)
                x, states, base, residual = x + step, moved, prediction, left
                stray = stray_windows(problem, residual)
                if stray.any():
                    found = settle(problem.part(stray), hypothesis, x, states[stray], ROUNDS)
                    states[stray], base[stray], residual[stray] = found
                break
        if gain < ENOUGH:
            break
    return here


def linear_gain(information: Array, gradient: Array) -> float:
    """Fall of chi2 that a Newton step promises, for summed information (p, p) and gradient (p,)."""
    if not len(gradient):
        return 0.0
    return float(gradient @ inverse(information + 1e-9 * np.diag(np.diag(information))) @ gradient)
