"""Backward elimination on whole runs, confirmation on held-out runs, and indistinguishable hypotheses."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from swamp_rl.criticism.likelihood.adequacy import near
from swamp_rl.criticism.likelihood.cross_validation import (
    Confirmation,
    confirmation,
    confirmed_at,
    stretch_losses,
)
from swamp_rl.criticism.likelihood.output_error import Fit, at_states, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, joined
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.continuation import CORRECTED, LAST, MIDDLE, Continuation
from swamp_rl.criticism.selection.score_test import ScoreTest, score_tests

Nuisance = Literal["commands", "position noise"]


@dataclass(frozen=True)
class Selection:
    """The result of a search.

    winner: the fit at the deepest stage used; adequate: whether its residual is noise; stage: the longest
    windows on which it is adequate, else the middle ones; rivals: fits indistinguishable from the winner;
    tried: every fit to the shortest windows; first: score tests beside no effect, on the shortest windows
    that show more than noise; unidentifiable: labels of effects with too little information; confirmed: of
    each cause, by label; beside: the nuisance that suffices beside the best single effect, at which the
    search then ended.
    """

    winner: Fit
    adequate: bool
    stage: int
    rivals: list[Fit]
    tried: list[Fit]
    first: list[ScoreTest]
    unidentifiable: list[str]
    confirmed: dict[str, Confirmation] = field(default_factory=dict)
    beside: Nuisance | None = None


def fit_by_continuation(continuation: Continuation, hypothesis: Hypothesis, x: np.ndarray) -> Fit:
    """The fit to the middle windows, started from the fit to the shortest."""
    continuation.fit(0, hypothesis, x)
    return continuation.fit(1, hypothesis, x)


def adequate_stage(continuation: Continuation, at: Fit) -> int | None:
    """The stage, middle windows or whole runs, on which the residual of a fit is noise, or None."""
    if continuation.is_adequate(1, at):
        return 1
    if near(continuation.problems[1], at):
        return next((stage for stage, _ in adequate_whole(continuation, at)), None)
    return None


def adequate_whole(continuation: Continuation, at: Fit) -> Iterator[tuple[int, Fit]]:
    """The stages of whole runs on which a hypothesis leaves noise, and its fit there."""
    for stage in (LAST, CORRECTED):
        whole = continuation.at(stage, at)
        if continuation.is_adequate(stage, whole):
            yield stage, whole


def conclude(
    continuation: Continuation,
    best: Fit,
    tried: list[Fit],
    first: list[ScoreTest],
    unidentifiable: list[str],
    instances: Sequence[EffectInstance],
) -> Selection:
    """The selection after elimination and confirmation of `best` where it is adequate; instances: all
    candidates.
    """
    comparisons = len(instances) * (1 + len(best.hypothesis.instances))
    best = beside_kinks(continuation, best, MIDDLE)
    stage = adequate_stage(continuation, best)
    if stage is None:
        return Selection(best, False, MIDDLE, [], tried, first, unidentifiable)
    stage, best = next(adequate_whole(continuation, best), (stage, best))
    if stage >= LAST:
        best = beside_kinks(continuation, best, stage)
    best, adequate = pruned(continuation, best, stage), True
    confirmed = confirmations(continuation, best, best.hypothesis.instances, comparisons, stage)
    for label, one in confirmed.items():
        if adequate and not one.gains:
            less = without(continuation, best, label, stage)
            adequate = continuation.is_adequate(stage, less)
            best = less if adequate else best
    kept = {instance.label for instance in best.hypothesis.instances}
    confirmed = {label: one for label, one in confirmed.items() if label in kept}
    found = Selection(best, adequate, stage, [], tried, first, unidentifiable, confirmed)
    return _with_rivals(continuation, found, instances) if adequate else found


def beside_kinks(continuation: Continuation, best: Fit, stage: int) -> Fit:
    """The best fit at a stage, or one that begins half a step of the integration from a time in it, to either
    side of a kink of the likelihood, if that is better.
    """
    run_set = continuation.problems[stage].run_set
    half = 0.5 * run_set.dt / run_set.parts
    low, high = best.hypothesis.bounds()
    for index, spec in enumerate(best.hypothesis.specs):
        for away in (-half, half) if spec.is_time else ():
            x = best.x.copy()
            x[index] = np.clip(x[index] + away, low[index], high[index])
            best = continuation.refitted(stage, best, x, best.states, options().fit_steps, fresh=True)
    return best


def _with_rivals(
    continuation: Continuation, found: Selection, instances: Sequence[EffectInstance]
) -> Selection:
    """The best of all fits and its rivals; what replaces the winner must be confirmed on held-out runs."""
    plain = with_special_cases(continuation, found.winner, instances, found.stage)
    special = alternatives_to_nuisance(continuation, plain, instances)
    best, rivals, stage = compare(continuation, plain, [*found.tried, *special], found.stage)
    less = pruned(continuation, best, stage)
    if less is not best and continuation.is_adequate(stage, less):
        least = continuation.criterion(less) + options().strong_evidence
        best, rivals = less, [one for one in rivals if continuation.criterion(one) < least]
    best = with_special_cases(continuation, best, instances, stage)
    rivals = [with_special_cases(continuation, one, instances, stage) for one in rivals]
    new = _new_confirmations(continuation, replace(found, stage=stage), best, instances)
    if new is None:
        rivals = [best] if found.winner.hypothesis.instances else []
        best, stage, new = plain, found.stage, _new_confirmations(continuation, found, plain, instances)
    if new is None:
        best, new = found.winner, {}
    apart = {one.hypothesis.cause_label: one for one in reversed(rivals)}
    apart.pop(best.hypothesis.cause_label, None)
    rivals = [
        one
        for one in reversed(apart.values())
        if not nested(best.hypothesis, one.hypothesis)
        or continuation.criterion(one) < continuation.criterion(best) + options().separation_general
        or any(one.hypothesis.label == other.hypothesis.label for other in special)
    ][: options().most_rivals]
    return replace(found, winner=best, stage=stage, rivals=rivals, confirmed=found.confirmed | new)


def _new_confirmations(
    continuation: Continuation, found: Selection, best: Fit, instances: Sequence[EffectInstance]
) -> dict[str, Confirmation] | None:
    """Confirmations of the effects of a fit that the selection does not have; None if one gains nothing."""
    put = [instance for instance in best.hypothesis.instances if instance.label not in found.confirmed]
    comparisons = len(instances) * (1 + len(best.hypothesis.instances))
    new = confirmations(continuation, best, put, comparisons, found.stage)
    return new if all(one.gains for one in new.values()) else None


def without_unconfirmed(
    continuation: Continuation, found: Selection, instances: Sequence[EffectInstance]
) -> Selection:
    """An inadequate selection without the causes that no held-out run confirms, the least confirmed first."""
    best = found.winner
    while True:
        every = best.hypothesis.instances
        comparisons = len(instances) * (1 + len(every))
        confirmed = confirmations(continuation, best, every, comparisons, found.stage)
        if all(one.holds for one in confirmed.values()):
            return replace(found, winner=best, confirmed=confirmed)
        worst = min(confirmed, key=lambda label: confirmed[label].low)
        best = without(continuation, best, worst, found.stage)


def without(continuation: Continuation, best: Fit, label: str, stage: int) -> Fit:
    """The best fit less one effect, fitted at a stage from the best fit's parameters; where that is clearly
    worse than on shorter windows, which suggests a local minimum, also from the fit to those.
    """
    made = _from_best(continuation, best, label, stage)
    if stage == 0 or made.chi2 <= best.chi2 + options().clearly:
        return made
    shorter = continuation.at(stage - 1, best)
    below = without(continuation, shorter, label, stage - 1)
    if below.chi2 > shorter.chi2 + options().clearly:
        return made
    start = below.x, continuation.carried(below, stage)
    return continuation.refitted(stage, made, *start, options().fit_steps, fresh=True)


def _from_best(continuation: Continuation, best: Fit, label: str, stage: int) -> Fit:
    """The best fit less one effect, from the best fit's parameters, or a known fit if that is better."""
    less = best.hypothesis.without(label)
    known = continuation.fits.get((stage, less.label))
    if known is not None and not less.instances:
        return known
    _, x = joined(best.parts(but=label))
    if known is not None and known.chi2 > best.chi2 + options().overwhelming:
        # the known fit may not have converged
        glance = fit(continuation.problem(stage, less), less, x, best.states, options().glance_steps)
        if glance.chi2 > best.chi2 + options().overwhelming:
            return known
    if known is None:
        return continuation.fit_from(stage, less, x, best.states, options().fit_steps, fresh=True)
    return continuation.refitted(stage, known, x, best.states, options().fit_steps, fresh=True)


def pruned(continuation: Continuation, best: Fit, stage: int) -> Fit:
    """The best fit less the effects whose removal lowers the information criterion."""
    for instance in best.hypothesis.instances:
        if indispensable(continuation, best, instance.label, stage):
            continue
        less = without(continuation, best, instance.label, stage)
        if continuation.criterion(less) <= continuation.criterion(best):
            return pruned(continuation, less, stage)
    return best


def indispensable(continuation: Continuation, best: Fit, label: str, stage: int) -> bool:
    """Whether removing an effect raises the criterion by `clearly` on shorter windows already; by
    `overwhelming` where whole runs have other commands in gaps than those windows.
    """
    least = options().overwhelming if stage >= LAST and continuation.gaps else options().clearly
    for shorter in range(stage):
        whole = continuation.at(shorter, best)
        less = without(continuation, whole, label, shorter)
        if continuation.criterion(less) > continuation.criterion(whole) + least:
            return True
    return False


def confirmations(
    continuation: Continuation, best: Fit, causes: Sequence[EffectInstance], comparisons: int, judged: int
) -> dict[str, Confirmation]:
    """Of some causes of the best fit: the gain on runs that its parameters were not fitted to, on the
    shortest windows on which it is significant, else at the stage `judged`.
    """
    found: dict[str, Confirmation] = {}
    for instance in causes:
        if instance.effect.nuisance and len(best.hypothesis.instances) > 1:
            continue
        for stage in (0, 1, LAST):
            whole = continuation.at(stage, best)
            less = without(continuation, whole, instance.label, stage)
            one = confirmed_on(continuation, stage, whole, less, options().stages_tested * comparisons)
            if one.holds or stage == min(judged, LAST):
                found[instance.label] = one
            if one.holds:
                break
    return found


def confirmed_on(
    continuation: Continuation, stage: int, whole: Fit, less: Fit, comparisons: int
) -> Confirmation:
    """Of what `whole` has more than `less`, on held-out windows of a stage, on stretches of whole runs."""
    if stage < LAST:
        return confirmation(continuation.problems[stage], whole, less, comparisons)
    lost = [stretch_losses(continuation.problem(stage, one.hypothesis), one) for one in (less, whole)]
    gains = lost[0] - lost[1]
    return confirmed_at(gains[np.isfinite(gains)], comparisons)


def with_special_cases(
    continuation: Continuation, best: Fit, instances: Sequence[EffectInstance], stage: int
) -> Fit:
    """The best fit with special cases of its effects, where adequate and of no greater criterion."""
    for instance in best.hypothesis.instances:
        for special in instances:
            is_case = nested(Hypothesis((special,)), Hypothesis((instance,))) and special.effect.parameters
            if special.label == instance.label or special.groups or not is_case:
                continue
            plain = with_special(continuation, best, instance, special, stage)
            noise = continuation.is_adequate(stage, plain)
            if noise and continuation.criterion(plain) <= continuation.criterion(best):
                return with_special_cases(continuation, plain, instances, stage)
    return best


def with_special(
    continuation: Continuation, best: Fit, instance: EffectInstance, special: EffectInstance, stage: int
) -> Fit:
    """The best fit with a special case in place of one effect: begun from the numbers that they share, else
    by continuation from the score test of the special case beside the other effects. Where it is one of
    these, they alone.
    """
    rest, fields = best.parts(but=instance.label), [p.field for p in special.effect.parameters]
    if special in best.hypothesis.instances:
        return continuation.at(stage, fit_by_continuation(continuation, *joined(rest)))
    shared = instance.by_group(best.x[best.hypothesis.columns(instance.label)]).mean(axis=0)
    numbers = {p.field: x for p, x in zip(instance.effect.parameters, shared, strict=True)}
    if numbers.keys().isdisjoint(fields):
        base = at_states(
            continuation.problems[0], *joined(rest), continuation.at(0, best).states, options().score_rounds
        )
        (score,) = score_tests(continuation.problems[0], base, [special])
        return continuation.at(stage, fit_by_continuation(continuation, score.hypothesis, score.x))
    begin = zip(fields, (special.starts or special.grid)[0], strict=True)
    own = np.array([numbers.get(field, start) for field, start in begin])
    return continuation.fit(stage, *joined([*rest, (special, own)]), best.states)


def alternatives_to_nuisance(
    continuation: Continuation, best: Fit, instances: Sequence[EffectInstance]
) -> list[Fit]:
    """The best fit with another effect on a hull derivative that is far from its prior."""
    far = {
        parameter.field
        for nuisance, own in best.parts()
        if not nuisance.groups
        for parameter, spec, value in zip(nuisance.effect.parameters, nuisance.specs, own, strict=True)
        if spec.prior is not None and abs(value - spec.mean) > options().nuisance_limit * spec.prior
    }
    if not far:
        return []
    found = []
    for instance in instances:
        moves = {parameter.field for parameter in instance.effect.parameters}
        if not instance.effect.nuisance and moves & far and instance not in best.hypothesis.instances:
            own = (instance, np.array(instance.starts[0]))
            states = continuation.at(0, best).states
            found.append(continuation.fit(0, *joined([*best.parts(), own]), states))
    return found


def nested(small: Hypothesis, large: Hypothesis) -> bool:
    """Whether `small` is a special case of `large`."""

    def holds(instance: EffectInstance) -> bool:
        """Whether `large` has the effect, one that acts on the same fields and more, one that is declared to
        contain it, or the same with parameters for each group of runs.
        """
        fields = {parameter.field for parameter in instance.effect.parameters}

        def contains(one: EffectInstance) -> bool:
            more = bool(fields) and fields < {parameter.field for parameter in one.effect.parameters}
            by_group = not instance.groups and one.groups and one.of_one.label == instance.label
            larger = (more and one.selectors == instance.selectors) or instance.of_one.label in one.contains
            return bool(one.label == instance.label or by_group or larger)

        return any(map(contains, large.instances))

    return all(holds(instance) for instance in small.instances)


def compare(
    continuation: Continuation, best: Fit, tried: Sequence[Fit], stage: int
) -> tuple[Fit, list[Fit], int]:
    """The best of all fits and its rivals at one stage, each only on shorter windows before; and that stage.
    Where whole runs of a close one diverged, all are compared on the middle windows.
    """
    criterion = continuation.criterion
    near = criterion(continuation.at(1, best)) + options().compared
    here = criterion(continuation.at(0, best)) + options().compared
    every = [best]
    for one in tried:
        if one.hypothesis.label == best.hypothesis.label or criterion(one) > here:
            continue
        if criterion(fit_by_continuation(continuation, one.hypothesis, one.x)) <= near:
            every.append(continuation.at(stage, one))
    most = options().diverged * continuation.problems[stage].samples
    if stage > 1 and any(one.chi2 > most for one in every):
        stage = 1
        every = [continuation.at(stage, one) for one in every]
    every.sort(key=criterion)
    close = [one for one in every[1:] if criterion(one) < criterion(every[0]) + options().strong_evidence]
    apart = {one.hypothesis.cause_label: one for one in reversed(close)}
    apart.pop(every[0].hypothesis.cause_label, None)
    return every[0], sorted(apart.values(), key=criterion), stage
