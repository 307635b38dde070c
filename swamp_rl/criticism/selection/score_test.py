"""Score test: the expected fall of chi2 by each further effect, from one Jacobian without a fit."""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, bounded_step, fit_states, inverse
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, neutral_of
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.frequency_scan import wave_starts
from swamp_rl.criticism.threads import each

Array = NDArray[np.float64]
T = TypeVar("T")


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
    """Score tests of every effect beside `at`, least expected chi2 first; of none that changes nothing there
    for want of another. The problem keeps those of the last fits: a search asks for them again.
    """
    own = {instance.label for instance in at.hypothesis.instances}
    instances = [one for one in instances if one.label not in own and at.hypothesis.is_beside(one)]
    base, where = _base_of(problem, at), (at.hypothesis, at.x, at.states)
    by_x = base.once("by x", lambda: parameter_jacobian(problem, *where, problem.track(*where)))
    made = each(lambda instance: _score_test(_Added(base.apart(), instance, by_x)), instances)
    problem.boat_steps[0] += sum(steps for _, steps in made)
    return sorted((one for one, _ in made), key=lambda one: one.expected_chi2)


def score_tests_from_neutral(
    problem: Shooting, at: Fit, instances: Sequence[EffectInstance]
) -> list[ScoreTest]:
    """Score tests in no order, begun from the effects' neutral values; from its own starts if an effect has
    no information at its neutral value, as the water's depth, whose neutral value is deep water.
    """
    begun = [
        one if one.effect.begin == "spectral" else at_neutral_values(one, problem.boat) for one in instances
    ]
    scores = score_tests(problem, at, begun)
    kept = [one for one in scores if one.information >= options().least_information]
    shown, tested = ({one.instance.label for one in some} for some in (kept, scores))
    flat = [one for one in instances if one.label in tested - shown]
    return [*kept, *score_tests(problem, at, flat)] if flat else kept


@dataclass(frozen=True)
class _Base:
    """A fit that effects are added to, and what was computed for that, with its boat steps."""

    problem: Shooting
    at: Fit
    known: dict[Hashable, tuple[int, Any]] = field(default_factory=dict)

    def once(self, key: Hashable, make: Callable[[], T]) -> T:
        """What `make` gives, or has given for this key; either way its boat steps count."""
        count = self.problem.boat_steps
        if key in self.known:
            count[0] += self.known[key][0]
            return cast(T, self.known[key][1])
        before, made = count[0], make()
        self.known[key] = count[0] - before, made
        return made

    def apart(self) -> "_Base":
        """The same for another thread: what is computed once stays common, boat steps count apart."""
        return replace(self, problem=self.problem.apart())


def _base_of(problem: Shooting, at: Fit) -> _Base:
    base = next((one for one in problem.scores if one.at is at), None)
    if base is None:
        base = _Base(problem, at)
        problem.scores = [*problem.scores, base][-options().most_scores :]
    return base


@dataclass(frozen=True)
class _Added:
    """An effect instance added to a fit; by_x: (W, M, p) Jacobian by the parameters of that."""

    base: _Base
    instance: EffectInstance
    by_x: Array

    @cached_property
    def hypothesis(self) -> Hypothesis:
        """All effects together."""
        return self.base.at.hypothesis.with_instance(self.instance)

    @cached_property
    def place(self) -> NDArray[np.bool_]:
        """(p,) which parameters are the instance's."""
        return self.hypothesis.columns(self.instance.label)

    def x(self, own: Array) -> Array:
        """(V, p) the parameters of the fit and those of the instance (V, p_instance)."""
        x = np.empty((len(own), len(self.place)))
        x[:, ~self.place], x[:, self.place] = self.base.at.x, own
        return x


def _score_test(added: _Added) -> tuple[ScoreTest, int]:
    """The score test, and the boat steps that it took or once has taken."""
    made = added.base.once(added.instance, lambda: _of_best_start(added))
    return made, added.base.problem.boat_steps[0]


def _of_best_start(added: _Added) -> ScoreTest:
    base, instance = added.base, added.instance
    problem, at = base.problem, base.at
    starts: list[tuple[float, ...]] = [start * instance.count for start in instance.starts]

    def neutral() -> tuple[float, ...]:
        return neutral_start(instance, problem.boat) * instance.count

    if instance.effect.begin == "spectral":
        waves = base.once("waves", lambda: wave_starts(problem, at, added.by_x))
        starts = [tuple(start) for start in waves]
    elif instance.effect.begin == "changepoint":
        starts = [(failure_start(added),)]
    elif instance.size > 0:
        if instance.grid:
            starts.append(_best_grid_point(added))
        if at.chi2 < options().large_chi2 * problem.samples:  # a small residual has a small cause
            starts.append(neutral())
    distinct = [np.array(one) for one in dict.fromkeys(starts)]
    results = [_score_step(added, one) for one in distinct]
    diverged = not any(np.isfinite(one.expected_chi2) for one in results)
    if instance.size > 0 and diverged and neutral() not in starts:
        results.append(_score_step(added, np.array(neutral())))
    information = max(one.information for one in results)
    return replace(min(results, key=lambda one: one.expected_chi2), information=information)


def at_neutral_values(instance: EffectInstance, boat: Boat) -> EffectInstance:
    """The effect instance begun from its neutral values."""
    return replace(instance, starts=(neutral_start(instance, boat),), grid=())


def neutral_start(instance: EffectInstance, boat: Boat) -> tuple[float, ...]:
    """Neutral values of one group's parameters; beside them where a derivative does not exist."""
    specs = instance.of_one.specs
    neutral = [neutral_of(parameter, boat) for parameter in instance.effect.parameters]
    if instance.effect.vector:  # of no size, and so of no direction
        neutral = [options().neutral_step * spec.scale for spec in specs]
    return tuple(float(np.clip(x, s.low, s.high)) for x, s in zip(neutral, specs, strict=True))


def failure_start(added: _Added) -> float:
    """The best instant of a failure, from simulations without the thruster."""
    problem, at, by_x = added.base.problem, added.base.at, added.by_x
    _, dead = nearer_states(problem, added.hypothesis, added.x(np.zeros((1, 1)))[0], at)
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
    return _refined(added, found)


def nearer_states(problem: Shooting, hypothesis: Hypothesis, x: Array, at: Fit) -> tuple[Array, Array]:
    """States (W, 6) and residual (W, M) under a large jump, such as a failure or a swap, at x (p,): of each
    window the fit's or the measured ones, whichever leave less: the fit may have bent its own for want of the
    jump, so far that the simulation diverges.
    """
    states, residual = at.states, problem.residuals(problem.track(hypothesis, x, at.states))
    if at.chi2 < options().large_chi2 * problem.samples:
        return states, residual
    measured = problem.initial_states()
    other = problem.residuals(problem.track(hypothesis, x, measured))
    none = np.zeros((*residual.shape, 0))
    left = (normal_equations(at.states_jacobian, none, r).profile_chi2 for r in (residual, other))
    own, others = (np.where(np.isfinite(one), one, np.inf) for one in left)
    nearer = (others < own)[:, None]
    return np.where(nearer, measured, states), np.where(nearer, other, residual)


def _refined(added: _Added, found: float) -> float:
    """The best instant about `found` [s], from simulations of the windows about it alone."""
    problem, at = added.base.problem, added.base.at
    win = problem.windows
    length = win.rows * problem.dt
    begins, ends = win.first * problem.dt, (win.first + win.steps) * problem.dt
    times = np.maximum(found + np.linspace(-length, length, options().instants), 0.0)
    near = (begins < times[-1]) & (ends > times[0])
    x, part = added.x(times[:, None]), problem.part(near)
    states = np.broadcast_to(at.states[near], (len(x), near.sum(), 6))
    left = part.residuals(part.predict(added.hypothesis, x, states))
    none = np.zeros((*at.residual[near].shape, 0))
    losses = [float(normal_equations(at.states_jacobian[near], none, r).profile_chi2.sum()) for r in left]
    return float(times[int(np.argmin(np.nan_to_num(losses, nan=np.inf)))])  # NaN where the boat diverges


def _best_grid_point(added: _Added) -> tuple[float, ...]:
    """The grid point of least profile chi2, of each group where an effect differs between groups."""
    problem, at, instance = added.base.problem, added.base.at, added.instance
    points, groups = np.array(instance.grid), np.array(instance.groups)
    slopes = added.by_x[..., :0] if instance.groups else added.by_x
    group = groups[problem.run_set.origins[problem.windows.run]] if instance.groups else None
    losses = []
    for start in range(0, len(points), options().grid_batch):
        x = added.x(np.tile(points[start : start + options().grid_batch], instance.count))
        states = np.broadcast_to(at.states, (len(x), *at.states.shape))
        for residual in problem.residuals(problem.predict(added.hypothesis, x, states)):
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


def _score_step(added: _Added, start: Array) -> ScoreTest:
    """The score test from one start, the same whatever the instance's other ones."""
    alone = replace(added.instance, starts=(), grid=()), start.tobytes()
    made = added.base.once(alone, lambda: _stepped(added, start))
    return replace(made, hypothesis=added.hypothesis, instance=added.instance)


def _stepped(added: _Added, start: Array) -> ScoreTest:
    problem, at, hypothesis, place = added.base.problem, added.base.at, added.hypothesis, added.place
    (x,) = added.x(start[None])
    jump = added.instance.effect.begin == "changepoint" or not len(start)
    states = nearer_states(problem, hypothesis, x, at)[0] if jump else at.states
    base = problem.track(hypothesis, x, states)
    residual = problem.residuals(base)
    if not len(start) and at.chi2 > options().large_chi2 * problem.samples:  # a large jump
        states, _, residual = fit_states(problem, hypothesis, x, states, options().score_rounds)
    slopes = np.zeros((*residual.shape, len(place)))
    slopes[..., ~place] = added.by_x
    slopes[..., place] = parameter_jacobian(problem, hypothesis, x, states, base, place)
    normal = normal_equations(at.states_jacobian, slopes, residual)
    mean, precision = hypothesis.prior()
    H = normal.information.sum(axis=0) + np.diag(precision)
    g = normal.gradient.sum(axis=0) - precision * (x - mean)
    moved = bounded_step(H, g, x, *hypothesis.bounds())
    loss = float(normal.profile_chi2.sum() + precision @ (x - mean) ** 2 - 2 * g @ moved + moved @ H @ moved)
    own = np.diag(normal.information.sum(axis=0))[place] * added.instance.scales**2
    changed = float(((problem.residuals(base) - at.residual) ** 2).sum())
    information = float(own.max()) if len(own) else changed
    loss = loss if np.isfinite(loss) else np.inf
    information = information if np.isfinite(information) else 0.0
    changed = changed if np.isfinite(changed) else 0.0
    return ScoreTest(hypothesis, added.instance, x, states, loss, max(information, changed))
