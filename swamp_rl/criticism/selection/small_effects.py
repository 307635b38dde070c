"""Selection on longer windows of effects too small for short ones, whose action accumulates over a run."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance, by_label
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import (
    beside_kinks,
    confirmed_on,
    fit_by_continuation,
    without,
)
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation
from swamp_rl.criticism.selection.frequency_scan import scan_size
from swamp_rl.criticism.selection.score_test import ScoreTest, score_tests_from_neutral

Array = NDArray[np.float64]


def with_small_effects(
    continuation: Continuation, best: Fit, instances: Sequence[EffectInstance], judged: Sequence[str]
) -> tuple[Fit, list[Fit]]:
    """The best fit with effects that only whole runs show, and alternatives to those hardly shown before.

    instances: all candidates; judged: labels of those identifiable on the shortest windows. The others are
    alternatives to every effect: no fit has compared them before.
    """
    at = beside_kinks(continuation, continuation.at(LAST, best), LAST)
    problem = continuation.problem(LAST, at.hypothesis)
    several = len(np.unique(problem.windows.run)) > 1
    if not several or at.chi2 > options().diverged * problem.samples:
        return best, []
    # Parameters of one run cannot be confirmed on another, and whole runs accumulate every other error.
    instances = [instance for instance in instances if not instance.groups]
    if continuation.is_adequate(MIDDLE, best) and scan_size(problem) > options().largest_scan:
        instances = [instance for instance in instances if instance.effect.begin != "spectral"]
    more = _forward_selection(continuation, at, instances, LAST)
    if more.hypothesis != at.hypothesis:
        added = fit_by_continuation(continuation, more.hypothesis, more.x)
        if continuation.is_adequate(LAST, more):
            best, at = added, more
    every = [at, *_alternatives(continuation, at, instances, judged)]
    return best, [continuation.at(0, one) for one in every if one.hypothesis.instances]


def with_slow_effects(continuation: Continuation, best: Fit, instances: Sequence[EffectInstance]) -> Fit:
    """The best fit, on the middle windows, with effects that the shortest hardly show: a ship's mass takes
    longer to act. instances: all candidates.
    """
    more = _forward_selection(continuation, continuation.at(MIDDLE, best), instances, MIDDLE)
    return fit_by_continuation(continuation, more.hypothesis, more.x)


def _forward_selection(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], stage: int
) -> Fit:
    """The fit at a stage with further effects that lower the criterion and predict held-out data better."""
    while len(at.hypothesis.instances) < options().most_effects:
        scores = _ranked(continuation, at, instances, stage)
        if not scores:
            break
        best = _fitted(continuation, at, instances, scores, stage)[0]
        (added,) = set(best.hypothesis.instances) - set(at.hypothesis.instances)
        less = without(continuation, best, added.label, stage)
        if less.chi2 < at.chi2 - options().not_converged:
            at = less
            continue
        kept = confirmed_on(continuation, stage, best, less, options().stages_tested * len(instances))
        if continuation.criterion(best) >= continuation.criterion(less) or not kept.gains:
            break
        at = best
    return at


def _alternatives(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], judged: Sequence[str]
) -> list[Fit]:
    """Whole runs with another effect for one, of a close criterion, if short windows did not compare them."""
    criterion = continuation.criterion
    found: list[Fit] = []
    short = continuation.at(0, at)
    for instance in at.hypothesis.instances:
        shorter = without(continuation, short, instance.label, 0)
        shown = criterion(shorter) > criterion(short) + options().compared
        known = {instance.label, *(judged if shown else ())}
        others = [one for one in instances if one.label not in known]
        if not others:
            continue
        less = without(continuation, at, instance.label, LAST)
        fitted = _fitted(continuation, less, others, _ranked(continuation, less, others, LAST), LAST)
        found += [one for one in fitted if criterion(one) < criterion(at) + options().compared]
    return found


def is_small(instance: EffectInstance) -> bool:
    """Whether an instance has a continuous size; a failure has only an instant, which short windows show."""
    return instance.size > 0 and instance.effect.begin != "changepoint"


def _ranked(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], stage: int
) -> list[ScoreTest]:
    """The most promising score tests of one more effect at a stage, in order."""
    problem = continuation.problem(stage, at.hypothesis)
    criterion = continuation.criterion
    scores = [
        one
        for one in score_tests_from_neutral(problem, at, [one for one in instances if is_small(one)])
        if one.information >= options().least_information
        and at.chi2 - one.expected_chi2 > criterion.required_gain(at.hypothesis, one.instance)
    ]
    return sorted(scores, key=criterion.expected)[: options().small_shortlist]


def _fitted(
    continuation: Continuation,
    at: Fit,
    instances: Sequence[EffectInstance],
    scores: Sequence[ScoreTest],
    stage: int,
) -> list[Fit]:
    """Fits at a stage of the given score tests, in their order up to one far above the best, best first."""
    criterion, known, made = continuation.criterion, by_label(instances), list[Fit]()
    for one in scores:
        if made:
            best = min(made, key=criterion)
            room = options().follow_fit + options().follow_share_far * (at.chi2 - best.chi2)
            if criterion.expected(one) > criterion(best) + room:
                break
        hypothesis = at.hypothesis.with_instance(known[one.instance.label])
        made.append(continuation.fit(stage, hypothesis, one.x, at.states))
    return sorted(made, key=criterion)
