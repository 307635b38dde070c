"""Output error by Gauss and Newton: parameters shared by all windows, an initial state for each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.settle import enough, losses, settle
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

DAMPINGS = (0.0, 1.0, 4.0, 16.0, 64.0)  # steps tried are shorter than one reach (below) over this
STRAY, ROUNDS = 1.35, 4  # times the median loss that marks a stray window, steps it is given of its own
# share of the promised gain below which a Jacobian is taken anew, where a step gains less than CLOSE and more
TRUSTED, TRUSTED_AFAR, CLOSE = 0.6, 0.9, 30.0
WORSE = 10.0  # chi2 by which a step makes a window worse before it is given steps of its own
STATE_REACH = np.array([0.5, 0.5, 0.2, 0.2, 0.2, 0.2])  # m, m, rad, m/s, m/s, rad/s
STUCK = 2.0  # chi2 that a window's own state promises to save where a fit has ended too early
RELEASES = 3  # times that a fit goes on after that
FAR = 4.0  # reaches that a window's state does not go in one step


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


def stray_windows(problem: Shooting, residual: Array) -> NDArray[np.bool_]:
    """(W,) windows that fit far worse than the others: their initial state went astray."""
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)), 1)
    share = (residual**2).sum(axis=1) / seen
    stray = share > STRAY * np.median(share)
    return stray if stray.sum() <= len(stray) // 3 else np.zeros_like(stray)


@dataclass
class Point:
    """Where a fit stands: x (p,), states (W, 6), prediction and residual there."""

    x: Array
    states: Array
    base: Array
    residual: Array
    penalty: float

    @property
    def loss(self) -> Array:
        """(W,) chi2 of each window."""
        return losses(self.residual)

    @property
    def chi2(self) -> float:
        """Prior included."""
        return float(self.loss.sum()) + self.penalty


Slopes = tuple[Array, Array]


def fit(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, steps: int = 8, fresh: bool = False
) -> Fit:
    """The hypothesis fitted from x (p,) and states (W, 6), with at most `steps` Jacobians (Levenberg,
    Marquardt), each used for as long as it keeps what it promises. fresh: end with one taken where the fit
    ends.
    """
    x, states = np.array(x, dtype=float), np.array(states, dtype=float)
    base = problem.predict(hypothesis, x[None], states[None])[0]
    at = Point(x, states, base, problem.residuals(base), prior_penalty(hypothesis, x))
    freed = _released(problem, hypothesis, at, problem.state_jacobian(hypothesis, x, states, base), WORSE)
    at = freed or at
    slopes, start, used = slopes_at(problem, hypothesis, at), 0, 1
    newest, first, released = True, True, 0
    while True:
        moved, start, kept = _step(problem, hypothesis, at, slopes, start, first)
        first = False
        gain = at.chi2 - moved.chi2
        at, newest = moved, newest and gain == 0.0
        least = enough(problem, at.chi2)
        if gain > least and kept > (TRUSTED if gain < CLOSE else TRUSTED_AFAR):
            continue
        if newest or used >= steps or (kept > TRUSTED and not fresh):
            freed = (
                _released(problem, hypothesis, at, slopes[0], max(STUCK, least))
                if released < RELEASES
                else None
            )
            if freed is None:
                break
            at, released = freed, released + 1
        slopes, used, newest = slopes_at(problem, hypothesis, at), used + 1, True
    if fresh and not newest:
        slopes = slopes_at(problem, hypothesis, at)
    return Fit(
        hypothesis,
        at.x,
        at.states,
        at.residual,
        at.loss,
        normal_equations(*slopes, at.residual),
        at.penalty,
        slopes[0],
        used,
    )


def slopes_at(problem: Shooting, hypothesis: Hypothesis, at: Point) -> Slopes:
    """Jacobians by states (W, M, 6) and by parameters (W, M, p)."""
    return (
        problem.state_jacobian(hypothesis, at.x, at.states, at.base),
        problem.parameter_jacobian(hypothesis, at.x, at.states, at.base),
    )


def _step(
    problem: Shooting, hypothesis: Hypothesis, at: Point, slopes: Slopes, start: int, first: bool
) -> tuple[Point, int, float]:
    """The first of ever shorter steps that lowers chi2, the damping to begin the next one with, and the share
    of the promised gain that was kept; `at` itself and 0 where none does.
    """
    mean, precision = hypothesis.prior()
    low, high = hypothesis.bounds()
    reach = np.array([spec.scale for spec in hypothesis.specs])
    for number in range(start, len(DAMPINGS)):
        damping = DAMPINGS[number]
        normal = normal_equations(*slopes, at.residual, damping)
        H = normal.information.sum(axis=0) + np.diag(precision + len(at.states) * (damping / reach) ** 2)
        g = normal.gradient.sum(axis=0) - precision * (at.x - mean)
        step = bounded_step(H, g, at.x, low, high)
        promised = at.chi2 - float(normal.free.sum()) - at.penalty + float(2 * g @ step - step @ H @ step)
        if number == 0 and promised < enough(problem, at.chi2):
            return at, 0, 1.0
        moved = _moved(problem, hypothesis, at, step, normal.shift(step), first)
        if moved.chi2 < at.chi2:
            return moved, max(0, number - 2), (at.chi2 - moved.chi2) / max(promised, 1e-12)
    return at, max(0, len(DAMPINGS) - 2), 0.0


def _released(
    problem: Shooting, hypothesis: Hypothesis, at: Point, by_state: Array, least: float
) -> Point | None:
    """The point with the windows settled that promise by themselves to save `least` chi2 or more; None where
    none does.
    """
    none = np.zeros((*at.residual.shape, 0))
    could = at.loss - normal_equations(by_state, none, at.residual).free > least
    if not could.any():
        return None
    base, states, residual = at.base.copy(), at.states.copy(), at.residual.copy()
    part, held = problem.part(could), problem.windows.measured[could, 0]
    starts = [states[could]] if problem.windows.pad == 0 else [states[could], held]
    for start in starts:  # where the fit stands, and where the boat was seen
        found = settle(part, hypothesis, at.x, start, 2 * ROUNDS)
        better = losses(found[2]) < losses(residual[could])
        place = np.flatnonzero(could)[better]
        states[place], base[place], residual[place] = (one[better] for one in found)
    moved = Point(at.x, states, base, residual, at.penalty)
    return moved if moved.chi2 < at.chi2 - enough(problem, at.chi2) else None


def _moved(
    problem: Shooting, hypothesis: Hypothesis, at: Point, step: Array, shift: Array, first: bool
) -> Point:
    """The point after a step (p,) and a shift of the states (W, 6); windows that it throws off are settled,
    at the first step of a fit also those that began astray.
    """
    x, states = at.x + step, at.states + shift
    base = problem.predict(hypothesis, x[None], states[None])[0]
    residual = problem.residuals(base)
    loss = losses(residual)
    off = (loss > at.loss + WORSE) | (np.abs(shift) > FAR * STATE_REACH).any(axis=1)
    if not 0 < off.sum() <= len(off) // 3:
        off = np.zeros_like(off)
    better = loss.sum() < at.chi2
    if first and better:
        off |= stray_windows(problem, residual)
    if off.any() and (better or loss[~off].sum() < at.loss[~off].sum()):
        found = settle(problem.part(off), hypothesis, x, at.states[off], ROUNDS)
        states[off], base[off], residual[off] = found
    return Point(x, states, base, residual, prior_penalty(hypothesis, x))
