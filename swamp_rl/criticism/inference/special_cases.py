"""Named causes that a special case of theirs replaces where that predicts no worse."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from swamp_rl.criticism.inference.cause_share import Witness, moves_less_than_noise, shares_of
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection, confirmations, with_special
from swamp_rl.criticism.selection.continuation import MIDDLE, Continuation


def with_sufficient_special_cases(
    continuation: Continuation,
    found: Selection,
    instances: Sequence[EffectInstance],
    on: Witness,
    noise: Mapping[str, float],
    rng: np.random.Generator,
) -> Selection:
    """The selection with those special cases of its effects that the library declares (`Effect.contains`),
    where the general effect lowers no prediction error: a thruster's gain for an efficiency that is even but
    for the rounding of the commands. The effects of a selection with rivals stay: they are compared.

    instances: all candidates; on: the runs that predictions are compared with; noise: standard deviation by
    channel (SI, rad).
    """
    if found.rivals:
        return found
    for instance in found.winner.hypothesis.instances:
        for special in instances:
            if special.label not in instance.contains:
                continue
            plain = with_special(continuation, found.winner, instance, special, found.stage)
            adequate = not found.adequate or continuation.is_adequate(found.stage, plain)
            if adequate and _predicts_as_well(continuation, plain, found, on, noise, rng):
                comparisons = len(instances) * (1 + len(plain.hypothesis.instances))
                confirmed = confirmations(continuation, plain, [special], comparisons, found.stage)
                simpler = replace(found, winner=plain, confirmed=found.confirmed | confirmed)
                return with_sufficient_special_cases(continuation, simpler, instances, on, noise, rng)
    return found


def _predicts_as_well(
    continuation: Continuation,
    plain: Fit,
    found: Selection,
    on: Witness,
    noise: Mapping[str, float],
    rng: np.random.Generator,
) -> bool:
    """Whether no error of the predictions is larger under a fit than under the winner, at any horizon. Where
    they differ by less than the sensor's noise, which is larger is chance: whole runs must not prefer the
    winner, and an error may be larger if middle windows prefer the fit.
    """
    shares = []
    for horizon in options().judged_horizons:
        before, _ = on.errors(continuation, found.stage, plain, horizon)
        after, block = on.errors(continuation, found.stage, found.winner, horizon)
        shares += shares_of(before, after, block, horizon, rng)
    larger = [one for one in shares if not one.without <= one.with_cause]
    criterion, pair = continuation.criterion, (plain, found.winner)
    by_chance = moves_less_than_noise(larger or shares, noise)
    if by_chance and criterion(plain) > criterion(found.winner) + options().strong_evidence:
        return False
    if not larger:
        return bool(shares)
    if not by_chance or any(one.ci95[0] > 0.0 for one in larger):
        return False
    middle = [criterion(continuation.at(MIDDLE, one)) for one in pair]
    return middle[0] <= middle[1]
