"""Beam search over sets of effects: the least information criterion whose residual is noise."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from swamp_rl.criticism.likelihood.adequacy import near
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.selection.backward_elimination import (
    Nuisance,
    Selection,
    adequate_stage,
    conclude,
    fit_by_continuation,
    nested,
)
from swamp_rl.criticism.selection.continuation import MIDDLE, Continuation
from swamp_rl.criticism.selection.exchange_search import exchange_search, single_exchanges
from swamp_rl.criticism.selection.score_test import ScoreTest, score_tests, score_tests_from_neutral
from swamp_rl.criticism.selection.small_effects import with_slow_effects, with_small_effects


def beam_search(
    continuation: Continuation,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    step_budget: float | None = None,
    sufficient_nuisance: Callable[[Continuation, Fit], tuple[Nuisance, Fit] | None] | None = None,
    previous: Sequence[Fit] = (),
) -> Selection:
    """Search from no effect to `most_effects` effects, until the residual is noise and no score test is
    significant. Effects are added on the shortest windows, or on the middle ones if the boat file leaves
    noise on the shortest: these then show no effect.

    step_budget: boat steps after which no further depth is begun, 0 for none at all; the first one is begun
    however many the boat file took. sufficient_nuisance: what the boat file or the best of the first depth
    needs in place of a further effect, and which of them; the search ends with it, without elimination where
    it is position noise. previous: the result of a search under other noise, at the shortest windows and the
    middle ones, which is tried too.
    """
    step_budget = options().step_budget if step_budget is None else step_budget
    criterion = continuation.criterion
    every = [*instances, *([hull] if hull else [])]
    best = fit_by_continuation(continuation, Hypothesis(), np.zeros(0))
    if previous:
        best = min(best, _refit_previous(continuation, previous), key=criterion)
    stage = adequate_stage(continuation, best) if not best.hypothesis.instances else None
    shown = MIDDLE if continuation.is_adequate(0, continuation.boat_file(0)) else 0
    begun = shown if stage is None else stage
    first = score_tests(continuation.problem(begun, Hypothesis()), continuation.boat_file(begun), every)
    if stage is not None:
        small, others = with_small_effects(continuation, best, every, _labels(_identifiable(every, first)))
        if not _is_significant(continuation, stage, small, every):
            return conclude(continuation, small, others, first, _unidentifiable(first), every)
        first = score_tests(continuation.problems[shown], continuation.boat_file(shown), every)
    unidentifiable, whole = _unidentifiable(first), every
    every = _identifiable(every, first)
    tried: dict[str, Fit] = {}
    if best.hypothesis.instances:
        tried[best.hypothesis.label] = continuation.at(shown, best)
    beam = [continuation.boat_file(shown)]
    for depth in range(options().most_effects):
        if depth == 1 and sufficient_nuisance:
            closest = best if best.hypothesis.instances else _closest(continuation, tried.values())
            found = sufficient_nuisance(continuation, closest)
            if found:  # an effect more would only absorb it
                beside, at = found
                every_tried = list(_on_shortest(continuation, tried).values())
                if beside == "position noise":
                    return Selection(at, False, MIDDLE, [], every_tried, first, unidentifiable, beside=beside)
                made = conclude(continuation, at, every_tried, first, unidentifiable, every)
                return replace(made, beside=beside)
        spent = continuation.boat_steps > step_budget and (depth > 0 or step_budget == 0.0)
        if spent or (depth > 0 and _is_sufficient(continuation, best, every)):
            break
        LOG.info("hypotheses of %d effect%s", depth + 1, "s" * (depth > 0))
        budget = step_budget if depth == options().most_effects - 1 else np.inf
        fitted = _expand(continuation, shown, beam, every, first if depth == 0 else None, budget)
        if not fitted:
            break
        tried |= {one.hypothesis.label: one for one in fitted}
        for one in _followed(continuation, shown, fitted):
            best = min(best, fit_by_continuation(continuation, one.hypothesis, one.x), key=criterion)
        # short windows alone do not tell which of two sets leads to one that leaves noise on longer ones
        far = adequate_stage(continuation, best) is None
        share = options().follow_share_far if far else options().follow_share
        room = options().follow_beam + share * (beam[0].chi2 - fitted[0].chi2)
        distinct = _distinct(fitted)[: options().beam]
        beam = [one for one in distinct if criterion(one) < criterion(fitted[0]) + room]
    if tried and adequate_stage(continuation, best) is None:
        best = min(best, _closest(continuation, tried.values()), key=criterion)
    tried = _on_shortest(continuation, tried)
    short, enough = continuation.problems[0], adequate_stage(continuation, best) is not None
    if not enough and near(short, continuation.at(0, best)):
        slow = with_slow_effects(continuation, best, whole)
        if slow.hypothesis != best.hypothesis:  # which an exchange on the shortest windows would not see
            best, enough = slow, True
            tried[best.hypothesis.label] = continuation.at(0, best)
    hopeless = best.chi2 > options().exchange_hopeless * continuation.problems[MIDDLE].samples
    if best.hypothesis.instances and not hopeless and not enough:
        LOG.info("exchanges of effects")
        exchanged = exchange_search(continuation, continuation.at(0, best), every)
        tried |= {one.hypothesis.label: continuation.at(0, one) for one in exchanged}
        best = min([best, *exchanged], key=criterion)
    elif enough and len(best.hypothesis.instances) > 1:
        exchanged = single_exchanges(continuation, continuation.at(0, best), every)
        tried |= {one.hypothesis.label: continuation.at(0, one) for one in exchanged}
    if near(continuation.problems[1], best):
        best, others = with_small_effects(continuation, best, whole, _labels(every))
        tried |= {one.hypothesis.label: one for one in others}
    return conclude(continuation, best, list(tried.values()), first, unidentifiable, every)


def _identifiable(instances: Sequence[EffectInstance], scores: Sequence[ScoreTest]) -> list[EffectInstance]:
    """Those with enough information in the data."""
    unidentifiable = _unidentifiable(scores)
    return [instance for instance in instances if instance.label not in unidentifiable]


def _distinct(fits: Sequence[Fit]) -> list[Fit]:
    """Those that are no special case or generalisation of an earlier one."""
    kept: list[Fit] = []
    for one in fits:
        pairs = [(one.hypothesis, other.hypothesis) for other in kept]
        if not any(nested(a, b) or nested(b, a) for a, b in pairs):
            kept.append(one)
    return kept


def _on_shortest(continuation: Continuation, tried: dict[str, Fit]) -> dict[str, Fit]:
    """The hypotheses of some fits, by label, fitted to the shortest windows."""
    return {label: continuation.at(0, one) for label, one in tried.items()}


def _labels(instances: Sequence[EffectInstance]) -> list[str]:
    return [instance.label for instance in instances]


def _refit_previous(continuation: Continuation, previous: Sequence[Fit]) -> Fit:
    """The fit to the middle windows, each stage begun from the result under other noise."""
    for stage, one in enumerate(previous):
        if len(one.states) == continuation.problems[stage].windows.count:
            made = fit(continuation.problems[stage], one.hypothesis, one.x, one.states)
            continuation.fits[stage, one.hypothesis.label] = made
    return fit_by_continuation(continuation, previous[0].hypothesis, previous[0].x)


def _closest(continuation: Continuation, fitted: Iterable[Fit]) -> Fit:
    """The fit to the middle windows of the hypothesis that fits the shortest best."""
    closest = min(fitted, key=continuation.criterion)
    return fit_by_continuation(continuation, closest.hypothesis, closest.x)


def _followed(continuation: Continuation, stage: int, fitted: list[Fit]) -> list[Fit]:
    """Of fits at a stage, the best first: those that are fitted to the middle windows, at least the best: an
    instant that the shortest windows missed, such as a failure's, may be found there.
    """
    criterion = continuation.criterion
    best = criterion(fitted[0])
    room = options().follow_adequate
    if not continuation.is_adequate(stage, fitted[0]):
        room += options().follow_inadequate * best
    close = [one for one in fitted[: options().followed] if criterion(one) < best + room]
    return [one for one in close if near(continuation.problems[stage], one)] or close[:1]


def _is_sufficient(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> bool:
    """Whether the residual of longer windows is noise and no further effect is significant there."""
    stage = adequate_stage(continuation, at)
    return stage is not None and not _is_significant(continuation, stage, at, instances)


def _unidentifiable(scores: Sequence[ScoreTest]) -> list[str]:
    """Labels of those with too little information in the data."""
    return [one.instance.label for one in scores if one.information < options().least_information]


def _is_significant(
    continuation: Continuation, stage: int, at: Fit, instances: Sequence[EffectInstance]
) -> bool:
    """Whether a score test exceeds an effect's required gain and a fit attains it: from its neutral values,
    since the residual is noise; the tests beside the boat file are those that the search began with.
    """
    here = continuation.at(stage, at)
    problem = continuation.problem(stage, here.hypothesis)
    tests = score_tests_from_neutral if here.hypothesis.instances else score_tests
    for one in tests(problem, here, instances):
        least = continuation.criterion.required_gain(here.hypothesis, one.instance)
        if here.chi2 - one.expected_chi2 > least:
            made = fit(problem, one.hypothesis, one.x, here.states, options().check_steps)
            if here.chi2 - made.chi2 > least:
                return True
    return False


def _base(prospect: ScoreTest) -> Hypothesis:
    return prospect.hypothesis.without(prospect.instance.label)


def _expand(
    continuation: Continuation,
    stage: int,
    beam: list[Fit],
    instances: Sequence[EffectInstance],
    known: list[ScoreTest] | None,
    step_budget: float,
) -> list[Fit]:
    """Fits at a stage of the sets of least expected criterion with one more effect, best first; beam: fits at
    that stage.

    Sets whose expected criterion is far above that of the first `always_fitted` are not fitted, effects
    without parameters excepted as long as nothing is adequate on longer windows too and a part of the windows
    does not refute them; once the step budget is spent, only the first are.
    """
    if not beam:
        return []
    criterion = continuation.criterion
    found: dict[str, ScoreTest] = {}
    for at in beam:
        scores = known if known is not None else score_tests(continuation.problems[stage], at, instances)
        for one in scores:
            label = one.hypothesis.label
            if one.information >= options().least_information and (
                label not in found or one.expected_chi2 < found[label].expected_chi2
            ):
                found[label] = one
    ranked = sorted(found.values(), key=criterion.expected)
    # The score of an effect without parameters, such as a swap of channels, is no guide: it is a jump.
    base = min(beam, key=criterion).hypothesis.label
    discrete = [
        one for one in ranked[options().shortlist :] if not one.instance.size and _base(one).label == base
    ]
    chosen = [*ranked[: options().shortlist], *discrete]
    fitted: list[Fit] = []
    limit, explained = np.inf, False
    for number, one in enumerate(chosen):
        if number >= options().always_fitted and continuation.boat_steps > step_budget:
            break
        expected = criterion.expected(one)  # which may overflow
        jump = not (one.instance.size or explained) and not _is_hopeless(continuation, stage, one, beam)
        if not fitted or expected < limit or jump:
            made = continuation.fit(stage, one.hypothesis, one.x, one.states)
            previous = min(at.chi2 for at in beam if at.hypothesis.label == _base(one).label)
            if stage == 0 and continuation.not_converged(made, previous, one.expected_chi2):
                made = continuation.restarted(made)
            fitted.append(made)
        best = min(fitted, key=criterion)
        enough = continuation.is_adequate(stage, best)
        if enough and one.instance.size:  # one jump is no reason to leave out another
            explained = continuation.is_adequate(MIDDLE, continuation.at(MIDDLE, best))
        if enough or number + 1 >= options().always_fitted:
            gained = max(at.chi2 - best.chi2 for at in beam)
            share = (1 if enough else 2) * options().follow_share
            limit = criterion(best) + options().follow_fit + share * gained
    return sorted(fitted, key=criterion)


def _is_hopeless(continuation: Continuation, stage: int, one: ScoreTest, beam: Sequence[Fit]) -> bool:
    """Whether an effect, fitted in full to one window of a stage in `jump_part`, has a greater chi2 on these
    windows than the hypothesis without it. A fit to all windows could differ.
    """
    problem = continuation.problems[stage]
    if problem.windows.count < options().jump_windows:
        return False
    chosen = np.arange(problem.windows.count) % options().jump_part == 0
    made = fit(problem.part(chosen), one.hypothesis, one.x, one.states[chosen])
    before = next(at for at in beam if at.hypothesis.label == _base(one).label)
    return float(made.loss.sum()) > float(before.loss[chosen].sum())
