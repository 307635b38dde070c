"""Exchange search: effects of a set for others while that lowers the criterion (sequential replacement,
Miller, Selection of subsets of regression variables, J. R. Stat. Soc. A 147, 1984).

A beam search that adds one effect at a time keeps a neighbour of the true effect, and the local minimum that
was best beside fewer effects. Here each effect in turn gives way while the others stay at their values, so
that its neighbours, and its own other starts, are judged beside all of them.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.output_error import Fit, at_states, fit
from swamp_rl.criticism.model.candidates import EffectInstance, by_label, joined
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.selection.backward_elimination import adequate_stage, fit_by_continuation
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.criticism.selection.score_test import ScoreTest, score_tests
from swamp_rl.criticism.selection.side_by_side import side_by_side

Array = NDArray[np.float64]


def exchange_search(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> list[Fit]:
    """Fits to the middle windows, each one exchange or one effect more from the last and of a lower criterion
    on the shortest, until the residual is noise, and then the rivals of the last; at: a fit to the shortest
    windows. Effects without a number, whose score is no guide, and with parameters for each group of runs
    take no part unless `at` has them.
    """
    found: list[Fit] = []
    most = continuation.boat_steps + options().exchange_budget
    while continuation.boat_steps <= most:
        best = _better(continuation, at, _taking_part(at, instances))
        if continuation.criterion(best) > continuation.criterion(at) - options().not_converged:
            break
        LOG.debug("exchange: %s for %s", best.hypothesis.label, at.hypothesis.label)
        at = best
        found.append(fit_by_continuation(continuation, at.hypothesis, at.x))
        if adequate_stage(continuation, found[-1]) is not None:
            return [*found, *single_exchanges(continuation, at, instances)]
    return found


def _taking_part(at: Fit, instances: Sequence[EffectInstance]) -> list[EffectInstance]:
    """Those of a number, alike in all groups of runs, and those of `at`, which whole runs may have found."""
    own = at.hypothesis.instances
    others = [one for one in instances if one.size and not one.groups and one not in own]
    return [*own, *others]


def single_exchanges(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> list[Fit]:
    """Fits to the middle windows of sets that differ from that of `at` in one effect and are about as good on
    the shortest: `at` was the first set that leaves noise, not the best of those. at: a fit to the shortest
    windows; `instances` as of `exchange_search`.
    """
    near, taking_part = continuation.criterion(at) + options().compared, _taking_part(at, instances)
    others = _neighbours(continuation, at, taking_part, options().follow_fit, more=False)
    close = [one for one in others if continuation.criterion(one) < near and one.hypothesis != at.hypothesis]
    return side_by_side(continuation, lambda own, one: fit_by_continuation(own, one.hypothesis, one.x), close)


def _better(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> Fit:
    """The neighbour of least criterion; where `at` leaves more than noise, the first that leaves noise."""
    best, noise = at, continuation.is_adequate(0, at)
    for one in _neighbours(continuation, at, instances):
        best = min(best, one, key=continuation.criterion)
        if not noise and continuation.is_adequate(0, best):
            break
    return best


def _neighbours(
    continuation: Continuation,
    at: Fit,
    instances: Sequence[EffectInstance],
    room: float = 0.0,
    more: bool = True,
) -> Iterator[Fit]:
    """Fits of the most promising sets, of an expected criterion below that of `at` plus `room`, that differ
    from that of `at` in one effect, or in where that begins; more: also those of one effect more.
    """
    problem = continuation.problems[0]
    if more and len(at.hypothesis.instances) < options().most_effects:
        yield from _promising(continuation, at, score_tests(problem, at, instances), instances, room)
    for instance, own in at.parts():
        base = at_states(problem, *joined(at.parts(but=instance.label)), at.states, options().score_rounds)
        others = [one for one in instances if one.label != instance.label]
        again = [_elsewhere(instance, own)] if instance.size else []
        scores = score_tests(problem, base, [*others, *again])
        yield from _promising(continuation, at, scores, instances, room)


def _promising(
    continuation: Continuation,
    at: Fit,
    scores: Sequence[ScoreTest],
    instances: Sequence[EffectInstance],
    room: float,
) -> list[Fit]:
    """Fits from the score tests of least expected criterion, where that is below the criterion of `at` plus
    `room`.
    """
    criterion, known = continuation.criterion, by_label(instances)
    likely = [one for one in scores if one.information >= options().least_information]
    likely = sorted(likely, key=criterion.expected)[: options().exchange_fits]
    chosen = [one for one in likely if criterion.expected(one) < criterion(at) + room]
    made = side_by_side(continuation, lambda own, one: _fitted(own, one, known[one.instance.label]), chosen)
    return [_better_known(continuation, one) for one in made]


def _elsewhere(instance: EffectInstance, own: Array) -> EffectInstance:
    """The instance begun from its starts, and from points to either side of its values (p,): what is recorded
    at every sample alone, such as a delay's effect, has a minimum for each.
    """
    if instance.groups:
        return instance
    sides = options().exchange_reach * np.diag(instance.scales)
    low, high = (np.array([getattr(s, end) for s in instance.specs]) for end in ("low", "high"))
    around = [np.clip(own + sign * side, low, high) for side, sign in itertools.product(sides, (1.0, -1.0))]
    return replace(instance, starts=(*instance.starts, *(tuple(map(float, point)) for point in around)))


def _fitted(continuation: Continuation, one: ScoreTest, instance: EffectInstance) -> Fit:
    hypothesis = one.hypothesis.without(instance.label).with_instance(instance)
    return fit(continuation.problems[0], hypothesis, one.x, one.states, options().stage_steps[0])


def _better_known(continuation: Continuation, made: Fit) -> Fit:
    """The fit, kept, or a known one of the same set if that is better."""
    known = continuation.fits.get((0, made.hypothesis.label))
    if known is not None and known.chi2 <= made.chi2:
        return known
    continuation.begin_again(made)
    return made
