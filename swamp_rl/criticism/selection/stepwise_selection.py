"""Stepwise selection under model error: effects are added while held-out windows confirm them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.cross_validation import Confirmation, confirmation, saturated_loss
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, joined, may_differ
from swamp_rl.criticism.nuisance.curve_errors import Marginal, beside_curve_errors
from swamp_rl.criticism.nuisance.process_noise import ModelError, model_error
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.selection.backward_elimination import Selection, nested, without
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.criticism.selection.information_criterion import information_criterion
from swamp_rl.criticism.selection.score_test import ScoreTest, score_tests
from swamp_rl.criticism.selection.side_by_side import side_by_side
from swamp_rl.criticism.threads import each

Array = NDArray[np.float64]


def select_under_model_error(
    run_set: RunSet,
    weight: Array,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    closest: Fit | None = None,
) -> tuple[RunSet, Continuation, Selection]:
    """Runs with the model error as noise, a continuation of one stage, the selection.

    closest: the best fit under white noise. In windows of `model_error_short` the model error is what it
    leaves, so that a cause is not its own noise (Mallows, Some comments on C_p, Technometrics 15, 1973). If
    no effect is confirmed there, it is what the boat file leaves in windows of `model_error_window`: weather
    is slow, and needs no other run if its likelihood ratio test finds it.
    """
    LOG.info("selection under model error")
    every = [*instances, *([hull] if hull else [])]
    tests = RatioTests(run_set, weight, len(every))
    nothing = Hypothesis(), np.zeros(0)
    beside = [nothing, *([(closest.hypothesis, closest.x)] if closest else [])]
    errors = each(lambda one: model_error(run_set, weight, *one, options().model_error_short), beside)
    found = _selected(min(errors, key=lambda one: one.volume), every, tests)
    if found[2].winner.hypothesis.instances:
        return found
    return _selected(model_error(run_set, weight, *nothing), every, replace(tests, alone=True))


@dataclass(frozen=True)
class RatioTests:
    """Likelihood ratio tests beside errors of the model's curves, at a level divided by the number of
    comparisons (Bonferroni).

    weight: (R, T, 6) of the measurement noise; alone: whether they decide on what no other run can confirm;
    marginals: of the hypotheses that were tested, by label and parameters.
    """

    run_set: RunSet
    weight: Array
    comparisons: int
    alone: bool = False
    marginals: dict[tuple[str, bytes], Marginal] = field(default_factory=dict)

    def marginal(self, at: Fit) -> Marginal:
        """The likelihood of a fit's hypothesis beside errors of the curves."""
        key = at.hypothesis.label, at.x.tobytes()
        if key not in self.marginals:
            self.marginals[key] = beside_curve_errors(self.run_set, self.weight, at.hypothesis, at.x)
        return self.marginals[key]

    def parameter_variances(self, at: Fit) -> Array:
        """(p,) of a fit's parameters beside errors of the curves."""
        return self.marginal(at).parameter_variances

    def find(self, whole: Fit, less: Fit) -> bool:
        """Whether `whole` is significantly more likely than `less`: chi2 of as many degrees of freedom as it
        has more parameters (Wilks 1938), one at least.
        """
        from scipy.special import chdtri

        freedom = max(whole.hypothesis.size - less.hypothesis.size, 1)
        least = float(chdtri(freedom, options().curve_errors_level / self.comparisons))
        return self.marginal(less).deviance - self.marginal(whole).deviance > least

    def decide(self, instance: EffectInstance) -> bool:
        """Whether they decide on an effect, since it may differ between runs."""
        runs = len(self.run_set.lengths)
        return self.alone and bool(instance.groups or (runs == 1 and may_differ(instance.effect, "run")))


def _selected(
    weighted: ModelError, every: Sequence[EffectInstance], tests: RatioTests
) -> tuple[RunSet, Continuation, Selection]:
    """The selection under one model error."""
    continuation = single_stage(weighted)
    weighted.problem.least_variances = tests.parameter_variances
    nothing = continuation.fit(0, Hypothesis(), np.zeros(0))
    best, first, singles = _forward_selection(continuation, nothing, every, tests)
    singles = sorted(singles, key=lambda one: _held_out_loss(continuation, one))
    others = [best, *_exchanged(continuation, best, singles)]
    unidentifiable = [one.instance.label for one in first if one.information < options().least_information]
    best, confirmed = best_confirmed(continuation, others, tests)
    best, confirmed = most_likely(continuation, best, confirmed, [*singles, *others], tests)
    best, confirmed = without_dispensable(continuation, best, confirmed, tests)
    rivals = equivalent(continuation, best, [*singles, *others])
    tried = {one.hypothesis.label: one for one in (*singles, *others, best)}
    found = Selection(best, False, 0, rivals, list(tried.values()), first, unidentifiable, confirmed)
    return weighted.run_set, continuation, found


def single_stage(weighted: ModelError) -> Continuation:
    """A continuation whose every stage is that of the model error, its fit known."""
    problem = weighted.problem
    criterion = information_criterion(problem.run_set, problem.samples / problem.correlation_samples)
    continuation = Continuation([problem] * 4, [problem.initial_states()] * 4, criterion)
    for stage in range(len(continuation.problems)):
        continuation.fits[stage, weighted.fit.hypothesis.label] = weighted.fit
    return continuation


def _held_out_loss(continuation: Continuation, one: Fit) -> float:
    return float(saturated_loss(continuation.problems[0], one).sum())


def _forward_selection(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], tests: RatioTests
) -> tuple[Fit, list[ScoreTest], list[Fit]]:
    """Effects of least confirmed held-out loss in turn; the first score tests, the single effects' fits."""
    problem = continuation.problems[0]
    first: list[ScoreTest] = []
    singles: list[Fit] = []
    for _ in range(options().most_effects):
        scores = _screened(continuation, at, instances)
        first = first or scores
        likely = [one for one in scores if one.information >= options().least_information]
        # of an effect without a number the score is no guide: it is a jump
        discrete = [one for one in likely[options().shortlist :] if not one.instance.size and not singles]
        likely = [*likely[: options().shortlist], *discrete]
        made = side_by_side(continuation, partial(_fitted, states=at.states, instances=instances), likely)
        singles = singles or made
        confirmed_fits = [
            one
            for score, one in zip(likely, made, strict=True)
            if _is_likely(problem, one, at, score.instance, tests)
        ]
        if not confirmed_fits:
            break
        best = min(confirmed_fits, key=lambda one: _held_out_loss(continuation, one))
        at = _simplest(continuation, best, confirmed_fits)
    return at, first, singles


def _fitted(
    continuation: Continuation, score: ScoreTest, states: Array, instances: Sequence[EffectInstance]
) -> Fit:
    made = continuation.fit(0, score.hypothesis, score.x, states)
    return _with_its_nuisance(continuation, made, instances)


def _with_its_nuisance(continuation: Continuation, one: Fit, instances: Sequence[EffectInstance]) -> Fit:
    """The fit, or one with what is a nuisance beside its effects alone, whichever has the lower criterion:
    step by step, an effect of exact numbers would come before one of guessed numbers.
    """
    beside = [each for each in instances if each.effect.beside]
    for score in score_tests(continuation.problems[0], one, beside):
        if score.information >= options().least_information:
            made = continuation.fit(0, score.hypothesis, score.x, score.states)
            one = min(one, made, key=continuation.criterion)
    return one


def _is_likely(problem: Shooting, whole: Fit, less: Fit, instance: EffectInstance, tests: RatioTests) -> bool:
    """Whether held-out windows confirm an effect, whose test is left for the end, or its test decides."""
    found = confirmation(problem, whole, less, tests.comparisons)
    return found.holds or (tests.decide(instance) and tested(found, whole, less, instance, tests).holds)


def tested(
    found: Confirmation, whole: Fit, less: Fit, instance: EffectInstance, tests: RatioTests
) -> Confirmation:
    """What held-out windows found of an effect that `whole` has more than `less`, with a likelihood ratio
    test. What a run has of its own no other run confirms, and one run has few windows: where those gain
    without being significant, the test alone decides.
    """
    if not found.holds and not (tests.decide(instance) and found.gains):
        return found
    return replace(found, significant=tests.find(whole, less))


def _simplest(continuation: Continuation, best: Fit, confirmed_fits: Sequence[Fit]) -> Fit:
    """The best fit, or a special case of it whose held-out loss is not significantly greater. Between weather
    that all runs share and each run's own the held-out loss itself decides: neither is the rarer.
    """
    scopeless = _without_scope(best.hypothesis)
    for one in confirmed_fits:
        less = one.hypothesis.size < best.hypothesis.size and nested(one.hypothesis, best.hypothesis)
        if (
            less
            and _without_scope(one.hypothesis) != scopeless
            and not confirmation(continuation.problems[0], best, one, 1).holds
        ):
            return one
    return best


def _without_scope(hypothesis: Hypothesis) -> set[str]:
    """Labels of its effects, whether they differ between runs or not."""
    return {instance.of_one.label for instance in hypothesis.instances}


def _screened(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> list[ScoreTest]:
    """Score tests beside a fit from a part of its windows, not of its own effects with another scope."""
    problem = continuation.problems[0]
    known = _without_scope(at.hypothesis)
    instances = [one for one in instances if one.of_one.label not in known]
    every = max(1, problem.samples // (problem.weight.shape[2] * options().screening_samples))
    chosen = np.arange(problem.windows.count) % every == 0
    part = problem.part(chosen)
    made = fit(part, at.hypothesis, at.x, at.states[chosen], options().part_steps)
    return score_tests(part, made, instances)


def _exchanged(continuation: Continuation, best: Fit, singles: Sequence[Fit]) -> list[Fit]:
    """The best fit with each of its effects exchanged for each of the best single ones."""
    tried = []
    for instance in best.hypothesis.instances:
        if instance.effect.nuisance:
            continue
        every = [one for one in singles if _is_other(one.hypothesis, best.hypothesis, instance)]
        for other in every[: options().most_exchanges]:
            exchanged = joined([*best.parts(but=instance.label), *other.parts()])
            tried.append(continuation.fit(0, *exchanged, best.states))
    return tried


def _is_other(single: Hypothesis, best: Hypothesis, instance: EffectInstance) -> bool:
    """Whether a single effect is another explanation than an instance of the best fit."""
    own = single.instances[0]
    special = nested(Hypothesis((instance,)), single) or nested(single, Hypothesis((instance,)))
    return not own.effect.nuisance and own not in best.instances and not special


def best_confirmed(
    continuation: Continuation, fits: Sequence[Fit], tests: RatioTests
) -> tuple[Fit, dict[str, Confirmation]]:
    """The fit of least held-out loss among fits less what held-out windows do not confirm of them.

    In the order of their own loss, up to the first whose own is greater than that of the best so far.
    """
    loss = partial(_held_out_loss, continuation)
    first, *others = sorted(fits, key=loss)
    best = _eliminated(continuation, first, tests)
    for one in others:
        if loss(one) > loss(best[0]):
            break
        best = min(best, _eliminated(continuation, one, tests), key=lambda each: loss(each[0]))
    return best


def _eliminated(
    continuation: Continuation, best: Fit, tests: RatioTests
) -> tuple[Fit, dict[str, Confirmation]]:
    """The best fit less the effects that held-out windows do not confirm, the least confirmed first, and then
    those that the ratio tests do not find.
    """
    problem, comparisons = continuation.problems[0], tests.comparisons
    while True:
        every = best.hypothesis.instances
        fits = side_by_side(continuation, partial(_without, best=best), every)
        less = dict(zip(every, fits, strict=True))
        found = {one: confirmation(problem, best, other, comparisons) for one, other in less.items()}
        doubtful = [one for one, held in found.items() if not (held.holds or tests.decide(one))]
        if not doubtful:
            found = {one: tested(found[one], best, other, one, tests) for one, other in less.items()}
            doubtful = [one for one, held in found.items() if not held.holds]
        if not doubtful:
            return best, {one.label: held for one, held in found.items()}
        best = less[min(doubtful, key=lambda one: found[one].low)]


def _without(continuation: Continuation, instance: EffectInstance, best: Fit) -> Fit:
    return without(continuation, best, instance.label, 0)


def most_likely(
    continuation: Continuation,
    best: Fit,
    confirmed: dict[str, Confirmation],
    others: Sequence[Fit],
    tests: RatioTests,
) -> tuple[Fit, dict[str, Confirmation]]:
    """The fit of least information criterion beside errors of the model's curves, of the best one and those
    that held-out windows do not separate from it, if it is confirmed whole; and what confirms it.
    """
    criterion = partial(_criterion, continuation, tests)
    rival = min((best, *equivalent(continuation, best, others)), key=criterion)
    if rival is not best:
        kept, found = _eliminated(continuation, rival, tests)
        if kept is rival:
            return rival, found
    return best, confirmed


def without_dispensable(
    continuation: Continuation, best: Fit, confirmed: dict[str, Confirmation], tests: RatioTests
) -> tuple[Fit, dict[str, Confirmation]]:
    """The fit less the effects whose removal lowers the information criterion beside errors of the model's
    curves, and what confirms the others: an effect with parameters for each run has more to pay than the
    ratio test asks of it.
    """
    for label in confirmed:
        less = without(continuation, best, label, 0)
        if _criterion(continuation, tests, less) < _criterion(continuation, tests, best):
            rest = {kept: one for kept, one in confirmed.items() if kept != label}
            return without_dispensable(continuation, less, rest, tests)
    return best, confirmed


def _criterion(continuation: Continuation, tests: RatioTests, one: Fit) -> float:
    """Information criterion beside errors of the model's curves."""
    return tests.marginal(one).deviance + continuation.criterion.charge(one.hypothesis)


def equivalent(continuation: Continuation, winner: Fit, others: Sequence[Fit]) -> list[Fit]:
    """Fits of as many effects whose held-out loss is not significantly greater, best first."""
    problem = continuation.problems[0]
    kept: dict[str, Fit] = {}
    for one in sorted(others, key=lambda one: _held_out_loss(continuation, one)):
        name = one.hypothesis.cause_label
        same = len(one.hypothesis.instances) == len(winner.hypothesis.instances)
        if not same or name in kept or name == winner.hypothesis.cause_label:
            continue
        if nested(winner.hypothesis, one.hypothesis):
            continue
        if not confirmation(problem, winner, one, options().shortlist).holds:
            kept[name] = one
    return list(kept.values())[: options().most_rivals]
