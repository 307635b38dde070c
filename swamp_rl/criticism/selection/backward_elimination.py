"""Backward elimination on whole runs, confirmation on held-out runs, and the hypotheses that are
indistinguishable from the selected one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from swamp_rl.criticism.likelihood.adequacy import adequacy, near
from swamp_rl.criticism.likelihood.cross_validation import (
    Confirmation,
    confirmation,
    confirmed_at,
    stretch_losses,
)
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, joined
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.continuation import CORRECTED, LAST, Continuation
from swamp_rl.criticism.selection.score_test import ScoreTest


@dataclass(frozen=True)
class Selection:
    """The result of a search.

    winner: the fit at the deepest stage used; adequate: whether its residual is noise; stage: the longest
    windows on which it is adequate, the middle ones where it is on none; rivals: fits that are
    indistinguishable from the winner; tried: every fit, on the shortest windows; first: score tests beside no
    effect, in order, on the shortest windows; unidentifiable: labels of effects with too little information;
    confirmed: of each cause, by its label.
    """

    winner: Fit
    adequate: bool
    stage: int
    rivals: list[Fit]
    tried: list[Fit]
    first: list[ScoreTest]
    unidentifiable: list[str]
    confirmed: dict[str, Confirmation] = field(default_factory=dict)


def fit_by_continuation(continuation: Continuation, hypothesis: Hypothesis, x: np.ndarray) -> Fit:
    """The fit to the middle windows, started from the fit to the shortest."""
    continuation.fit(0, hypothesis, x)
    return continuation.fit(1, hypothesis, x)


def adequate_stage(continuation: Continuation, at: Fit) -> int | None:
    """The stage at which the residual of a fit to the middle windows is noise, or None: those windows, or
    whole runs, in which commands in gaps are estimated.
    """
    if adequacy(continuation.problems[1], at).adequate:
        return 1
    if near(continuation.problems[1], at):
        for stage in (LAST, CORRECTED):
            whole = continuation.fit(stage, at.hypothesis, at.x)
            if adequacy(continuation.problem(stage, at.hypothesis), whole).adequate:
                return stage
    return None


def conclude(
    continuation: Continuation,
    best: Fit,
    tried: list[Fit],
    first: list[ScoreTest],
    unidentifiable: list[str],
    instances: Sequence[EffectInstance],
) -> Selection:
    """The selection after elimination and confirmation of `best`; instances: all candidates."""
    comparisons = len(instances) * (1 + len(best.hypothesis.instances))
    found = adequate_stage(continuation, best)
    stage, adequate = found or 1, found is not None
    if adequate:
        for longest in (LAST, CORRECTED):
            whole = continuation.fit(longest, best.hypothesis, best.x)
            if adequacy(continuation.problem(longest, best.hypothesis), whole).adequate:
                best, stage = whole, longest
                break
        best = pruned(continuation, best, stage)
    confirmed = confirmations(continuation, best, best.hypothesis.instances, comparisons)
    for label, one in confirmed.items():
        if adequate and not one.gains:
            less = without(continuation, best, label, stage)
            if adequacy(continuation.problem(stage, less.hypothesis), less).adequate:
                best = less
            else:
                adequate = False
    kept = {instance.label for instance in best.hypothesis.instances}
    confirmed = {label: one for label, one in confirmed.items() if label in kept}
    rivals: list[Fit] = []
    if adequate:
        best, rivals, stage, confirmed = _best_and_rivals(
            continuation, best, tried, instances, stage, confirmed
        )
    return Selection(best, adequate, stage, rivals, tried, first, unidentifiable, confirmed)


def _best_and_rivals(
    continuation: Continuation,
    confirmed_fit: Fit,
    tried: Sequence[Fit],
    instances: Sequence[EffectInstance],
    stage: int,
    confirmed: dict[str, Confirmation],
) -> tuple[Fit, list[Fit], int, dict[str, Confirmation]]:
    """The best of all fits, its rivals, their stage and the confirmations; `confirmed_fit` where no held-out
    run confirms what would replace it, which is then a rival.
    """
    special = alternatives_to_nuisance(continuation, confirmed_fit, instances)
    best, rivals, deepest = compare(continuation, confirmed_fit, [*tried, *special], stage)
    best = with_special_cases(continuation, best, instances, deepest)
    put = [instance for instance in best.hypothesis.instances if instance.label not in confirmed]
    new = confirmations(continuation, best, put, len(instances) * (1 + len(best.hypothesis.instances)))
    if not all(one.gains for one in new.values()):
        rivals = [best] if confirmed_fit.hypothesis.instances else []
        best, deepest, new = confirmed_fit, stage, {}
    rivals = [
        one
        for one in rivals
        if not nested(best.hypothesis, one.hypothesis)
        or continuation.criterion(one) < continuation.criterion(best) + options().separation_general
        or any(one.hypothesis.label == other.hypothesis.label for other in special)
    ]
    return best, rivals[: options().most_rivals], deepest, confirmed | new


def without_unconfirmed(
    continuation: Continuation, found: Selection, instances: Sequence[EffectInstance]
) -> Selection:
    """An inadequate selection without the causes that no held-out run confirms, the least confirmed first."""
    best, confirmed = found.winner, found.confirmed
    while not all(one.holds for one in confirmed.values()):
        worst = min(confirmed, key=lambda label: confirmed[label].low)
        best = without(continuation, best, worst, found.stage)
        comparisons = len(instances) * (1 + len(best.hypothesis.instances))
        confirmed = confirmations(continuation, best, best.hypothesis.instances, comparisons)
    return replace(found, winner=best, confirmed=confirmed)


def without(continuation: Continuation, best: Fit, label: str, stage: int) -> Fit:
    """The best fit less one effect, fitted at a stage from the best fit's parameters."""
    less = best.hypothesis.without(label)
    known = continuation.fits.get((stage, less.label))
    if known is not None and not less.instances:
        return known
    _, x = joined((one, own) for one, own in best.hypothesis.parts(best.x) if one.label != label)
    if known is not None and known.chi2 > best.chi2 + options().overwhelming:
        glance = fit(
            continuation.problem(stage, less), less, x, best.states, options().glance_steps
        )  # the known fit may not have converged
        if glance.chi2 > best.chi2 + options().overwhelming:
            return known
    before = continuation.problem(stage, less)
    made = continuation.fit_from(stage, less, x, best.states, options().fit_steps, fresh=True)
    if known is None or made.chi2 < known.chi2:
        return made
    continuation.keep(stage, before, known)
    return known


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
    """Whether the removal of an effect raises the criterion by `clearly` on shorter windows already: a bound
    that makes the fit to longer ones unnecessary.
    """
    for shorter in range(stage):
        whole = continuation.fit(shorter, best.hypothesis, best.x)
        less = without(continuation, whole, label, shorter)
        if continuation.criterion(less) > continuation.criterion(best) + options().clearly:
            return True
    return False


def confirmations(
    continuation: Continuation, best: Fit, causes: Sequence[EffectInstance], comparisons: int
) -> dict[str, Confirmation]:
    """Of some causes of the best fit: the gain on runs that its parameters were not fitted to."""
    found: dict[str, Confirmation] = {}
    for instance in causes:
        if instance.effect.nuisance and len(best.hypothesis.instances) > 1:
            continue
        for stage in (0, 1, LAST):
            whole = continuation.fit(stage, best.hypothesis, best.x)
            less = without(continuation, whole, instance.label, stage)
            one = confirmed_on(continuation, stage, whole, less, options().stages_tested * comparisons)
            known = found.get(instance.label)
            if known is None or (one.gains, one.low) > (known.gains, known.low):
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
    """The best fit with special cases in place of effects whose further parameters do not lower the
    criterion, where the residual is noise without them too.
    """
    for instance in best.hypothesis.instances:
        for special in instances:
            fields = {parameter.field for parameter in special.effect.parameters}
            if (
                special.label == instance.label
                or special.groups
                or not nested(Hypothesis((special,)), Hypothesis((instance,)))
                or not fields
            ):
                continue
            plain = _with_special(continuation, best, instance, special, stage)
            noise = adequacy(continuation.problem(stage, plain.hypothesis), plain).adequate
            if noise and continuation.criterion(plain) <= continuation.criterion(best):
                return with_special_cases(continuation, plain, instances, stage)
    return best


def _with_special(
    continuation: Continuation, best: Fit, instance: EffectInstance, special: EffectInstance, stage: int
) -> Fit:
    """The best fit with a special case in place of one effect, started from the best fit."""
    shared = instance.by_group(best.x[best.hypothesis.columns(instance.label)]).mean(axis=0)
    numbers = {p.field: x for p, x in zip(instance.effect.parameters, shared, strict=True)}
    begin = zip(special.effect.parameters, (special.starts or special.grid)[0], strict=True)
    own = np.array([numbers.get(p.field, start) for p, start in begin])
    kept = [(one, x) for one, x in best.hypothesis.parts(best.x) if one.label != instance.label]
    return continuation.fit(stage, *joined([*kept, (special, own)]), best.states)


def alternatives_to_nuisance(
    continuation: Continuation, best: Fit, instances: Sequence[EffectInstance]
) -> list[Fit]:
    """The best fit with an effect that acts on the same coefficient as one of the hull's derivatives, where
    the estimate of that derivative is far from its prior.
    """
    far = {
        parameter.field
        for nuisance, own in best.hypothesis.parts(best.x)
        if not nuisance.groups
        for parameter, spec, value in zip(nuisance.effect.parameters, nuisance.specs, own, strict=True)
        if spec.prior is not None and abs(value - 1.0) > options().nuisance_limit * spec.prior
    }
    if not far:
        return []
    found = []
    for instance in instances:
        moves = {parameter.field for parameter in instance.effect.parameters}
        if not instance.effect.nuisance and moves & far and instance not in best.hypothesis.instances:
            own = (instance, np.array(instance.starts[0]))
            states = continuation.fit(0, best.hypothesis, best.x).states
            found.append(continuation.fit(0, *joined([*best.hypothesis.parts(best.x), own]), states))
    return found


def nested(small: Hypothesis, large: Hypothesis) -> bool:
    """Whether `small` is a special case of `large`."""

    def holds(instance: EffectInstance) -> bool:
        """Whether `large` has the effect, one that acts on the same fields and more, one that is declared to
        contain it, or the same with parameters for each group of runs.
        """
        fields = {parameter.field for parameter in instance.effect.parameters}
        return any(
            one.label == instance.label
            or (
                fields
                and fields < {p.field for p in one.effect.parameters}
                and one.selectors == instance.selectors
            )
            or (not instance.groups and one.groups and one.of_one.label == instance.label)
            or (instance.effect.name in one.effect.contains and one.selectors == instance.selectors)
            for one in large.instances
        )

    return all(holds(instance) for instance in small.instances)


def compare(
    continuation: Continuation, best: Fit, tried: Sequence[Fit], stage: int
) -> tuple[Fit, list[Fit], int]:
    """The best of all fits and its rivals at one stage, each only on shorter windows before; and that stage.
    Where whole runs of a close one diverged, all are compared on the middle windows.
    """
    criterion = continuation.criterion
    near = criterion(continuation.fit(1, best.hypothesis, best.x)) + options().compared
    here = criterion(continuation.fit(0, best.hypothesis, best.x)) + options().compared
    every = [best]
    for one in tried:
        if one.hypothesis.label == best.hypothesis.label or criterion(one) > here:
            continue
        if criterion(fit_by_continuation(continuation, one.hypothesis, one.x)) <= near:
            every.append(continuation.fit(stage, one.hypothesis, one.x))
    if stage > 1 and any(
        one.chi2 > options().diverged * continuation.problems[stage].samples for one in every
    ):
        stage = 1
        every = [continuation.fit(stage, one.hypothesis, one.x) for one in every]
    every.sort(key=criterion)
    close = [one for one in every[1:] if criterion(one) < criterion(every[0]) + options().separation]
    apart = {one.hypothesis.cause_label: one for one in reversed(close)}
    apart.pop(every[0].hypothesis.cause_label, None)
    return every[0], sorted(apart.values(), key=criterion), stage
