"""Score test: the expected fall of chi2 by each further effect, from one Jacobian without a fit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, bounded_step, inverse, normal_equations
from swamp_rl.criticism.likelihood.state_fit import fit_states
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, neutral_of
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.frequency_scan import wave_starts

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ScoreTest:
    """Score test of an effect added to a hypothesis, at x (p,) and states (W, 6).

    expected_chi2: to second order; information: the Fisher information about each parameter of the effect
    alone, times its typical size squared, the largest of them: below about 10 the effect is not identifiable.
    """

    hypothesis: Hypothesis
    instance: EffectInstance
    x: Array
    states: Array
    expected_chi2: float
    information: float


def score_tests(problem: Shooting, at: Fit, instances: Sequence[EffectInstance]) -> list[ScoreTest]:
    """Score tests of every effect beside `at`, least expected chi2 first."""
    own = {instance.label for instance in at.hypothesis.instances}
    by_x = problem.parameter_jacobian(
        at.hypothesis, at.x, at.states, problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    )
    found = [_score_test(problem, at, instance, by_x) for instance in instances if instance.label not in own]
    return sorted(found, key=lambda one: one.expected_chi2)


def _score_test(problem: Shooting, at: Fit, instance: EffectInstance, by_x: Array) -> ScoreTest:
    hypothesis = at.hypothesis.with_instance(instance)
    place = hypothesis.columns(instance.label)
    starts: list[tuple[float, ...]] = [start * instance.count for start in instance.starts]
    if instance.effect.begin == "spectral":
        starts = [tuple(start) for start in wave_starts(problem, at, by_x)]
    elif instance.effect.begin == "changepoint":
        starts = failure_starts(problem, at, hypothesis, instance, by_x)
    elif instance.size > 0:
        if instance.grid:
            starts.append(_best_grid_point(problem, at, instance, hypothesis, place, by_x))
        if at.chi2 < options().large_chi2 * problem.samples:  # a small residual has a small cause
            (neutral,) = at_neutral_values(instance, problem.boat).starts
            starts.append(neutral * instance.count)
    distinct = [np.array(one) for one in dict.fromkeys(starts)]
    results = [_score_step(problem, at, instance, hypothesis, place, by_x, one) for one in distinct]
    if instance.size > 0 and not any(
        np.isfinite(one.expected_chi2) for one in results
    ):  # diverged at every start
        (neutral,) = at_neutral_values(instance, problem.boat).starts
        start = neutral * instance.count
        if start not in starts:
            results.append(_score_step(problem, at, instance, hypothesis, place, by_x, np.array(start)))
    information = max(one.information for one in results)
    return replace(min(results, key=lambda one: one.expected_chi2), information=information)


def at_neutral_values(instance: EffectInstance, boat: Boat) -> EffectInstance:
    """The effect instance begun from its neutral values, or the boat file's; `neutral_step` beside them where
    a derivative does not exist.
    """
    specs = instance.of_one.specs
    neutral = [neutral_of(parameter, boat) for parameter in instance.effect.parameters]
    if instance.effect.vector:  # of no size, and so of no direction
        neutral = [options().neutral_step * spec.scale for spec in specs]
    start = tuple(float(np.clip(x, s.low, s.high)) for x, s in zip(neutral, specs, strict=True))
    return replace(instance, starts=(start,), grid=())


def _joint(place: NDArray[np.bool_], old: Array, new: Array) -> Array:
    """(V, p) from the old parameters (p_old,) and the instance's (V, p_instance)."""
    x = np.empty((len(new), len(place)))
    x[:, ~place] = old
    x[:, place] = new
    return x


def failure_starts(
    problem: Shooting, at: Fit, hypothesis: Hypothesis, instance: EffectInstance, by_x: Array
) -> list[tuple[float, ...]]:
    """The best instant of a failure among the windows' starts, from one simulation: windows that begin before
    it keep the thruster, the others never had it.
    """
    place = hypothesis.columns(instance.label)
    dead = problem.residuals(
        problem.predict(hypothesis, _joint(place, at.x, np.zeros((1, 1))), at.states[None])[0]
    )
    both = [normal_equations(at.states_jacobian, by_x, r) for r in (at.residual, dead)]
    times = problem.windows.first * problem.dt
    best, found = np.inf, 0.0
    for time in np.unique(times):
        failed = times >= time
        loss = float(np.where(failed, both[1].profile_chi2, both[0].profile_chi2).sum())
        if at.hypothesis.size:
            g = np.where(failed[:, None], both[1].gradient, both[0].gradient).sum(axis=0)
            loss -= float(g @ inverse(both[0].information.sum(axis=0)) @ g)
        if loss < best:
            best, found = loss, float(time)
    return [(_refined(problem, at, hypothesis, place, found),)]


def _refined(
    problem: Shooting,
    at: Fit,
    hypothesis: Hypothesis,
    place: NDArray[np.bool_],
    found: float,
) -> float:
    """The best instant about `found` [s], from simulations of the windows about it alone."""
    win = problem.windows
    length = win.rows * problem.dt
    begins, ends = win.first * problem.dt, (win.first + win.steps) * problem.dt
    times = np.maximum(found + np.linspace(-length, length, options().instants), 0.0)
    near = (begins < times[-1]) & (ends > times[0])
    x = _joint(place, at.x, times[:, None])
    states = np.broadcast_to(at.states[near], (len(x), near.sum(), 6))
    left = problem.part(near).residuals(problem.part(near).predict(hypothesis, x, states))
    none = np.zeros((*at.residual[near].shape, 0))
    losses = [float(normal_equations(at.states_jacobian[near], none, r).profile_chi2.sum()) for r in left]
    return float(times[int(np.argmin(losses))])


def _best_grid_point(
    problem: Shooting,
    at: Fit,
    instance: EffectInstance,
    hypothesis: Hypothesis,
    place: NDArray[np.bool_],
    by_x: Array,
) -> tuple[float, ...]:
    """The grid point of least profile chi2; of an effect that differs between groups, that of each group, the
    other effects' parameters held.
    """
    points = np.array(instance.grid)
    slopes = by_x[..., :0] if instance.groups else by_x
    group = (
        np.array(instance.groups)[problem.run_set.origins[problem.windows.run]] if instance.groups else None
    )
    losses = []
    for start in range(0, len(points), options().grid_batch):
        x = _joint(place, at.x, np.tile(points[start : start + options().grid_batch], instance.count))
        states = np.broadcast_to(at.states, (len(x), *at.states.shape))
        for residual in problem.residuals(problem.predict(hypothesis, x, states)):
            if group is None:
                losses.append(np.array([_profile_chi2(at, slopes, residual)]))
            else:
                chi2 = normal_equations(at.states_jacobian, slopes, residual).profile_chi2
                losses.append(np.bincount(group, np.where(np.isfinite(chi2), chi2, np.inf), instance.count))
    return tuple(points[np.argmin(losses, axis=0)].ravel().tolist())


def _profile_chi2(at: Fit, by_x: Array, residual: Array) -> float:
    normal = normal_equations(at.states_jacobian, by_x, residual)
    loss = float(normal.profile_chi2.sum())
    if not np.isfinite(loss):
        return np.inf
    if at.hypothesis.size:
        H, g = normal.information.sum(axis=0), normal.gradient.sum(axis=0)
        loss -= float(g @ np.linalg.lstsq(H, g, rcond=1e-10)[0])
    return loss


def _score_step(
    problem: Shooting,
    at: Fit,
    instance: EffectInstance,
    hypothesis: Hypothesis,
    place: NDArray[np.bool_],
    by_x: Array,
    start: Array,
) -> ScoreTest:
    (x,) = _joint(place, at.x, start[None])
    base = problem.predict(hypothesis, x[None], at.states[None])[0]
    states, residual = at.states, problem.residuals(base)
    if not len(start) and at.chi2 > options().large_chi2 * problem.samples:  # a large jump
        states, _, residual = fit_states(problem, hypothesis, x, at.states, options().score_rounds)
    slopes = np.zeros((*residual.shape, len(place)))
    slopes[..., ~place] = by_x
    slopes[..., place] = problem.parameter_jacobian(hypothesis, x, at.states, base, place)
    normal = normal_equations(at.states_jacobian, slopes, residual)
    mean, precision = hypothesis.prior()
    H = normal.information.sum(axis=0) + np.diag(precision)
    g = normal.gradient.sum(axis=0) - precision * (x - mean)
    moved = bounded_step(H, g, x, *hypothesis.bounds())
    loss = float(normal.profile_chi2.sum() + precision @ (x - mean) ** 2 - 2 * g @ moved + moved @ H @ moved)
    scale = np.array([spec.scale for spec in instance.specs])
    own = np.diag(normal.information.sum(axis=0))[place] * scale**2
    changed = float(((problem.residuals(base) - at.residual) ** 2).sum())
    information = float(own.max()) if len(own) else changed
    loss = loss if np.isfinite(loss) else np.inf
    information = information if np.isfinite(information) else 0.0
    changed = changed if np.isfinite(changed) else 0.0
    return ScoreTest(hypothesis, instance, x, states, loss, max(information, changed))
