"""The causes of a diagnosis: which matter, in which order, and which are written to the boat file."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from swamp_rl.criticism.inference.cause_share import is_minor
from swamp_rl.criticism.inference.estimate import causes_of
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.result import Cause, HeldOut, Share
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.effects import LIBRARY


@dataclass(frozen=True)
class CauseList:
    """causes: by their share of the prediction error, the largest first; minor: those that do not matter;
    nuisance: the hull's derivatives beside a cause; sound: whether every number and standard error is finite.
    """

    causes: list[Cause]
    minor: list[Cause]
    nuisance: list[Cause]
    sound: bool


def list_causes(
    problem: Shooting,
    found: Selection,
    shares: Mapping[str, Sequence[Share]],
    left_out: Sequence[str],
    noise: Mapping[str, float],
) -> CauseList:
    """Every effect instance of the winner as a cause, a nuisance or a minor cause.

    shares: by label, and the labels of those that do not carry over, see `written_fit`; noise: standard
    deviation by channel (SI, rad).
    """
    labelled = dict(
        zip(
            (instance.label for instance in found.winner.hypothesis.instances),
            causes_of(problem, found.winner),
            strict=True,
        )
    )
    for label, cause in labelled.items():
        cause.share = list(shares.get(label, []))
        cause.carries_over = label not in left_out
        if label in found.confirmed:
            one = found.confirmed[label]
            cause.held_out = HeldOut(gain=one.gain, low=one.low, level=one.level)
    claimed = {label: cause for label, cause in labelled.items() if _is_finite(cause)}
    alone = all(LIBRARY[cause.effect].nuisance for cause in claimed.values())
    nuisance = [cause for cause in claimed.values() if LIBRARY[cause.effect].nuisance and not alone]
    named = [cause for cause in claimed.values() if LIBRARY[cause.effect].nuisance == alone]
    return CauseList(
        causes=sorted((one for one in named if not is_minor(one.share, noise)), key=_size, reverse=True),
        minor=[one for one in named if is_minor(one.share, noise)],
        nuisance=nuisance,
        sound=len(claimed) == len(labelled),
    )


def _size(cause: Cause) -> float:
    """The largest part of an error that a cause accounts for [1]."""
    fitted = [one for one in cause.share if one.wind == "fitted"]
    return max(((one.without - one.with_cause) / one.without for one in fitted), default=0.0)


def _is_finite(cause: Cause) -> bool:
    return all(math.isfinite(p.value + p.standard_error) for p in cause.parameters.values())
