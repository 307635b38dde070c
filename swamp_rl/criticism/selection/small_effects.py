"""Selection on whole runs of effects too small for short windows, whose action accumulates over a run."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance, by_label
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import confirmed_on, fit_by_continuation, without
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation
from swamp_rl.criticism.selection.score_test import ScoreTest, at_neutral_values, score_tests

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SmallEffects:
    """best: on the middle windows, with the effects found on whole runs; tried: alternatives, on the
    shortest.
    """

    best: Fit
    tried: list[Fit]


def with_small_effects(
    continuation: Continuation, best: Fit, instances: Sequence[EffectInstance], most: int
) -> SmallEffects:
    """The best fit with effects that only whole runs show, up to `most`, and alternatives to those that short
    windows hardly show.
    """
    at = continuation.fit(LAST, best.hypothesis, best.x)
    problem = continuation.problem(LAST, at.hypothesis)
    several = len(np.unique(problem.windows.run)) > 1
    if not several or at.chi2 > options().diverged * problem.samples:
        return SmallEffects(best, [])
    if adequacy(continuation.problems[MIDDLE], best).adequate:
        instances = [
            instance for instance in instances if instance.effect.begin != "spectral"
        ]  # found on the middle windows
    more = _forward_selection(continuation, at, instances, most)
    if more.hypothesis != at.hypothesis:
        added = fit_by_continuation(continuation, more.hypothesis, more.x)
        if adequacy(continuation.problem(LAST, more.hypothesis), more).adequate:
            best, at = added, more
    every = [at, *_alternatives(continuation, at, instances)]
    return SmallEffects(
        best, [continuation.fit(0, one.hypothesis, one.x) for one in every if one.hypothesis.instances]
    )


def _forward_selection(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], most: int
) -> Fit:
    """A fit to whole runs with further effects, each of which lowers the criterion and predicts held-out runs
    better.
    """
    while len(at.hypothesis.instances) < most:
        scores = _ranked(continuation, at, instances)
        if not scores:
            break
        best = _fitted(continuation, at, instances, scores)[0]
        (added,) = set(best.hypothesis.instances) - set(at.hypothesis.instances)
        less = without(continuation, best, added.label, LAST)
        if less.chi2 < at.chi2 - options().not_converged:
            at = less
            continue
        kept = confirmed_on(continuation, LAST, best, less, options().stages_tested * len(instances))
        if continuation.criterion(best) >= continuation.criterion(less) or not kept.gains:
            break
        at = best
    return at


def _alternatives(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> list[Fit]:
    """Fits to whole runs with another effect in place of one that the shortest windows hardly show, where
    their criterion is close.
    """
    criterion = continuation.criterion
    found: list[Fit] = []
    short = continuation.fit(0, at.hypothesis, at.x)
    for instance in at.hypothesis.instances:
        if criterion(without(continuation, short, instance.label, 0)) > criterion(short) + options().compared:
            continue
        less = without(continuation, at, instance.label, LAST)
        others = [one for one in instances if one.label != instance.label]
        fitted = _fitted(continuation, less, others, _ranked(continuation, less, others))
        found += [one for one in fitted if criterion(one) < criterion(at) + options().compared]
    return found


def is_small(instance: EffectInstance) -> bool:
    """Whether an instance has a continuous size; a failure has only an instant, which short windows show."""
    return instance.size > 0 and instance.effect.begin != "changepoint"


def _ranked(continuation: Continuation, at: Fit, instances: Sequence[EffectInstance]) -> list[ScoreTest]:
    """The most promising score tests of one more effect on whole runs, in order."""
    problem = continuation.problem(LAST, at.hypothesis)
    begun = [
        one if one.effect.begin == "spectral" else at_neutral_values(one, problem.boat)
        for one in instances
        if is_small(one)
    ]
    criterion = continuation.criterion
    scores = [
        one
        for one in score_tests(problem, at, begun)
        if at.chi2 - one.expected_chi2 > criterion.required_gain(at.hypothesis, one.instance)
    ]
    return sorted(scores, key=lambda one: one.expected_chi2 + criterion.charge(one.hypothesis))[
        : options().small_shortlist
    ]


def _fitted(
    continuation: Continuation, at: Fit, instances: Sequence[EffectInstance], scores: Sequence[ScoreTest]
) -> list[Fit]:
    """Fits to whole runs of the given score tests, best first."""
    known = by_label(instances)
    made = [
        continuation.fit(LAST, at.hypothesis.with_instance(known[one.instance.label]), one.x, at.states)
        for one in scores
    ]
    return sorted(made, key=continuation.criterion)
