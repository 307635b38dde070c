"""Output-error fit by damped Gauss-Newton: parameters common to all windows, an initial state for each."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian, state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import Jacobians, Normal, normal_equations
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis.

    x: (p,); states: (W, 6); residual: (W, M) in standard deviations; loss: (W,) chi2 of each window; normal:
    the normal equations there; penalty: of the prior; states_jacobian: (W, M, 6).
    """

    hypothesis: Hypothesis
    x: Array
    states: Array
    residual: Array
    loss: Array
    normal: Normal
    penalty: float
    states_jacobian: Array

    @property
    def chi2(self) -> float:
        """Sum of squared standardised residuals, prior included."""
        return float(self.loss.sum()) + self.penalty

    def parts(self, but: str = "") -> list[tuple[EffectInstance, Array]]:
        """Each effect with its parameters, but the one of that label and what changes nothing without it."""
        kept = self.hypothesis.without(but).instances
        return [(one, x) for one, x in self.hypothesis.parts(self.x) if one in kept]

    @property
    def covariance(self) -> Array:
        """(p, p) of x, the inverse of the Fisher information under white noise of the estimated variance."""
        return inverse(self.normal.information.sum(axis=0) + self.hypothesis.prior_precision)


def state_reach(problem: Shooting) -> Array:
    """(6,) a large step of an initial state."""
    return np.asarray(np.array(options().state_reach) * problem.scale)


def inverse(H: Array) -> Array:
    """Inverse of an information matrix (p, p), scaled; directions without information get a huge variance,
    and parameters without any no covariance with others.
    """
    if not len(H) or not np.isfinite(H).all():
        return np.full_like(H, np.inf)
    known = np.diag(H) > 0.0
    inner = H[np.ix_(known, known)]
    scale = np.sqrt(np.maximum(np.diag(inner), 1e-30))
    values, vectors = np.linalg.eigh(inner / np.outer(scale, scale))
    found = np.diag(np.where(known, 0.0, options().no_information))
    found[np.ix_(known, known)] = (vectors / np.maximum(values, 1e-12)) @ vectors.T / np.outer(scale, scale)
    return found


def prior_penalty(hypothesis: Hypothesis, x: Array) -> float:
    """Squared distance of x from the prior mean, in standard deviations."""
    away = x - hypothesis.prior()[0]
    return float(away @ hypothesis.prior_precision @ away)


def bounded_step(H: Array, g: Array, x: Array, low: Array, high: Array) -> Array:
    """Newton's step (p,) for information H and gradient g, projected onto the bounds."""
    step = np.zeros(len(x))
    if not (np.isfinite(H).all() and np.isfinite(g).all()):  # a simulation diverged
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


def fit_states(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    rounds: int,
    base: Array | None = None,
    farthest: Array | None = None,
) -> tuple[Array, Array, Array]:
    """States (W, 6), prediction and residual at least chi2 under x (p,), by Levenberg-Marquardt; base:
    (W, T + 1, 6) prediction to begin with, where known.

    Converged windows are not simulated again; a Jacobian is kept until its window moves. A step is shortened
    to `farthest` (6,): one over which the model is far from linear leads into a local minimum.
    """
    count = len(states)
    states = states.copy()
    base = problem.track(hypothesis, x, states) if base is None else base.copy()
    residual = problem.residuals(base)
    damping = np.zeros(count)
    A, b = np.zeros((count, 6, 6)), np.zeros((count, 6))
    active = moved = np.ones(count, dtype=bool)
    for _ in range(rounds):
        if moved.any():
            slopes = state_jacobian(chosen_windows(problem, moved), hypothesis, x, states[moved], base[moved])
            transposed = np.swapaxes(slopes, 1, 2)
            A[moved], b[moved] = transposed @ slopes, (transposed @ residual[moved, :, None])[..., 0]
        step = np.linalg.solve(_ridged(A, damping), b[..., None])[..., 0]
        active &= (step * b).sum(axis=1) > options().window_decrease
        if farthest is not None:
            step /= np.maximum(np.abs(step / farthest).max(axis=1, keepdims=True), 1.0)
        if not active.any():
            break
        part, tried = chosen_windows(problem, active), states[active] + step[active]
        prediction = part.track(hypothesis, x, tried)
        left = part.residuals(prediction)
        better = losses(left) < losses(residual[active])
        place = np.flatnonzero(active)
        won, lost = place[better], place[~better]
        states[won], base[won], residual[won] = tried[better], prediction[better], left[better]
        active = active.copy()
        active[lost[damping[lost] > options().last_damping]] = False
        damping[place] = next_damping(damping[place], better, options().first_damping)
        moved = np.zeros(count, dtype=bool)
        moved[won] = True
    return states, base, residual


def at_states(problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, rounds: int) -> Fit:
    """The hypothesis at x (p,) as a fit of the initial states alone, from states (W, 6)."""
    states, base, residual = fit_states(problem, hypothesis, x, states, rounds)
    at = Iterate(x, states, base, residual, prior_penalty(hypothesis, x))
    return _fitted(hypothesis, at, jacobians_at(problem, hypothesis, at))


def first_states(problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array) -> Array:
    """(W, 6) initial states that a fit of x (p,) begins with, fitted from those smoothed from the data."""
    farthest = options().farthest_state * state_reach(problem)
    return fit_states(problem, hypothesis, x, states, options().first_rounds, farthest=farthest)[0]


def noise_free(problem: Shooting, truth: Fit) -> Shooting:
    """The windows with the prediction of a fit as their measurements."""
    track = problem.track(truth.hypothesis, truth.x, truth.states)
    return Shooting(
        problem.run_set, problem.weight, problem.seconds, replace(problem.windows, measured=track)
    )


def next_damping(damping: Array, better: NDArray[np.bool_], first: float) -> Array:
    """(W,) Marquardt's damping after a step that was better or not; first: that after the first failure."""
    factor = options().damping_factor
    less = np.where(damping < first, 0.0, damping / factor)
    return np.where(better, less, factor * damping + first)


def losses(residual: Array) -> Array:
    """(W,) chi2 of each window's residuals (W, M), infinite where a simulation diverged."""
    with np.errstate(over="ignore", invalid="ignore"):
        loss = (residual**2).sum(axis=1)
    return np.asarray(np.where(np.isnan(loss), np.inf, loss))


def min_decrease(problem: Shooting, chi2: float) -> float:
    """Fall of chi2 below which a fit ends; larger where the fit is far from the data."""
    above_noise = chi2 - options().noise_chi2 * problem.samples
    return max(options().least_decrease, options().least_decrease_share * above_noise)


def chosen_windows(problem: Shooting, chosen: NDArray[np.bool_]) -> Shooting:
    """The problem on some of its windows (W,), itself where those are all."""
    return problem if chosen.all() else problem.part(chosen)


def _ridged(A: Array, damping: Array) -> Array:
    """(W, 6, 6) with Marquardt's multiple of the diagonal added."""
    diagonal = np.einsum("wii->wi", A) * (1e-11 + damping[:, None]) + 1e-12
    return np.asarray(A + diagonal[..., None] * np.eye(6))


def stray_windows(problem: Shooting, residual: Array) -> NDArray[np.bool_]:
    """(W,) windows that fit far worse than the others: their initial state has not converged."""
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)), 1)
    share = (residual**2).sum(axis=1) / seen
    stray = share > options().stray_window * np.median(share)
    return stray if stray.sum() <= len(stray) // options().strays_one_in else np.zeros_like(stray)


@dataclass
class Iterate:
    """An iterate: x (p,), states (W, 6), prediction and residual there."""

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


def fit(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    steps: int | None = None,
    fresh: bool = False,
    while_finite: bool = False,
) -> Fit:
    """The hypothesis fitted from x (p,) and states (W, 6) by Levenberg-Marquardt, with at most `steps`
    Jacobians.

    A Jacobian is kept while the gain ratio is high. fresh: the last Jacobian is taken at the solution.
    while_finite: the fit ends at a Jacobian of a window that diverges, with which x takes no step.
    """
    steps = options().fit_steps if steps is None else steps
    x, states = np.array(x, dtype=float), np.array(states, dtype=float)
    base = problem.track(hypothesis, x, states)
    at = Iterate(x, states, base, problem.residuals(base), prior_penalty(hypothesis, x))
    by_state = state_jacobian(problem, hypothesis, x, states, base)
    refitted = _with_states_refitted(problem, hypothesis, at, by_state, options().window_increase)
    at = refitted or at
    slopes, start, used = jacobians_at(problem, hypothesis, at, None if refitted else by_state), 0, 1
    newest, first, refits = True, True, 0
    while not (while_finite and newest and not np.isfinite(slopes.by_x).all()):
        moved, start, gain_ratio = _step(problem, hypothesis, at, slopes, start, first)
        first = False
        gain = at.chi2 - moved.chi2
        at, newest = moved, newest and gain == 0.0
        least = min_decrease(problem, at.chi2)
        good = options().gain_ratio if gain < options().close_gain else options().gain_ratio_far
        if gain > least and gain_ratio > good:
            continue
        if newest or used >= steps or (gain_ratio > options().gain_ratio and not fresh):
            if refits == options().most_refits:
                break
            least = max(options().state_gain, least)
            refitted = _with_states_refitted(problem, hypothesis, at, slopes.by_state, least)
            if refitted is None:
                break
            at, refits = refitted, refits + 1
        slopes, used, newest = jacobians_at(problem, hypothesis, at), used + 1, True
    if fresh and not newest:
        slopes = jacobians_at(problem, hypothesis, at)
    return _fitted(hypothesis, at, slopes)


def _fitted(hypothesis: Hypothesis, at: Iterate, slopes: Jacobians) -> Fit:
    normal = slopes.normal(at.residual)
    return Fit(hypothesis, at.x, at.states, at.residual, at.loss, normal, at.penalty, slopes.by_state)


def jacobians_at(
    problem: Shooting, hypothesis: Hypothesis, at: Iterate, by_state: Array | None = None
) -> Jacobians:
    """The Jacobians there; by_state: the one by states (W, M, 6), where known."""
    if by_state is None:
        by_state = state_jacobian(problem, hypothesis, at.x, at.states, at.base)
    return Jacobians(by_state, parameter_jacobian(problem, hypothesis, at.x, at.states, at.base))


def _step(
    problem: Shooting, hypothesis: Hypothesis, at: Iterate, slopes: Jacobians, start: int, first: bool
) -> tuple[Iterate, int, float]:
    """The first step of increasing damping that lowers chi2, the index of the damping to begin the next one
    with, and the gain ratio; `at` itself and 0 where no step does.
    """
    mean, precision = hypothesis.prior()[0], hypothesis.prior_precision
    low, high = hypothesis.bounds()
    reach = hypothesis.scales
    for number in range(start, len(options().dampings)):
        damping = options().dampings[number]
        normal = slopes.normal(at.residual, damping / state_reach(problem))
        H = normal.information.sum(axis=0) + precision + np.diag(len(at.states) * (damping / reach) ** 2)
        g = normal.gradient.sum(axis=0) - precision @ (at.x - mean)
        step = bounded_step(H, g, at.x, low, high)
        predicted_gain = (
            at.chi2 - float(normal.profile_chi2.sum()) - at.penalty + float(2 * g @ step - step @ H @ step)
        )
        if number == 0 and predicted_gain < min_decrease(problem, at.chi2):
            return at, 0, 1.0
        moved = _moved(problem, hypothesis, at, step, normal.shift(step), first)
        if moved.chi2 < at.chi2:
            return moved, max(0, number - 2), (at.chi2 - moved.chi2) / max(predicted_gain, 1e-12)
    return at, max(0, len(options().dampings) - 2), 0.0


def _with_states_refitted(
    problem: Shooting, hypothesis: Hypothesis, at: Iterate, by_state: Array, least: float
) -> Iterate | None:
    """The iterate with the initial states refitted in those windows in which that alone promises to save
    `least` chi2; None where no window does.
    """
    none = np.zeros((*at.residual.shape, 0))
    could = at.loss - normal_equations(by_state, none, at.residual).profile_chi2 > least
    if not could.any():
        return None
    base, states, residual = at.base.copy(), at.states.copy(), at.residual.copy()
    part, held = problem.part(could), problem.windows.measured[could, 0]
    starts: list[tuple[Array, Array | None]] = [(states[could], base[could])]
    if problem.windows.pad > 0:
        starts.append((held, None))
    for start, known in starts:  # the current states, and the measured ones
        found = fit_states(part, hypothesis, at.x, start, 2 * options().stray_rounds, known)
        better = losses(found[2]) < losses(residual[could])
        place = np.flatnonzero(could)[better]
        states[place], base[place], residual[place] = (one[better] for one in found)
    moved = Iterate(at.x, states, base, residual, at.penalty)
    return moved if moved.chi2 < at.chi2 - min_decrease(problem, at.chi2) else None


def _moved(
    problem: Shooting, hypothesis: Hypothesis, at: Iterate, step: Array, shift: Array, first: bool
) -> Iterate:
    """The iterate after a step (p,) and a shift of the states (W, 6); the initial states of windows that
    become worse are refitted, at the first step also those of stray windows.
    """
    x, states = at.x + step, at.states + shift
    base = problem.track(hypothesis, x, states)
    residual = problem.residuals(base)
    loss = losses(residual)
    far = np.abs(shift) > options().farthest_state * state_reach(problem)
    off = (loss > at.loss + options().window_increase) | far.any(axis=1)
    if not 0 < off.sum() <= len(off) // options().strays_one_in:
        off = np.zeros_like(off)
    better = loss.sum() < at.chi2
    if first and better:
        off |= stray_windows(problem, residual)
    if off.any() and (better or loss[~off].sum() < at.loss[~off].sum()):
        found = fit_states(problem.part(off), hypothesis, x, at.states[off], options().stray_rounds)
        states[off], base[off], residual[off] = found
    return Iterate(x, states, base, residual, prior_penalty(hypothesis, x))
