"""Whether the data prefer a wrong answer to the truth: the difference of their information criteria.

Both sets of effects are fitted to whole runs, begun from their own values, at level D beside the hull's
derivatives, under the position noise that the answer tells and the commands as logged. Where the difference
is negative, the search missed the truth. Where it is not, as of a curve that the runs show in one point
alone, no search by this criterion would have named it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import CHANNELS, read_run_set
from swamp_rl.criticism.likelihood.gauss_markov import white_noise
from swamp_rl.criticism.model.candidates import EffectInstance, joined
from swamp_rl.criticism.selection.backward_elimination import fit_by_continuation
from swamp_rl.criticism.selection.continuation import LAST, Continuation, continuation_of
from swamp_rl.criticism.selection.preparation import prepared
from swamp_rl.one_thread import one_thread

Judged = Mapping[str, Any]
Key = tuple[str, frozenset[str]]
POSITIONS = ("north", "east")
Part = tuple[EffectInstance, NDArray[np.float64]]


@one_thread()
@np.errstate(over="ignore", invalid="ignore")
def criterion_of_truth(data: Path, truth: Judged, found: Judged) -> float | None:
    """Information criterion of the true effects less that of the answer's. None where either is not a set of
    effects that all runs share.
    """
    causes = [*found["causes"], *found["minor"], *found["nuisance"]]
    if truth["outside"] or truth.get("by_run") or any(cause["scope"] != "boat" for cause in causes):
        return None
    run_set = read_run_set(data, load_boat(truth.get("boat", "swamp")))
    known = prepared(run_set)
    run_set = replace(run_set, gauss_markov=_position_noise(found, known.sigmas))
    hull = [known.hull] if known.hull else []
    instances = {
        _key(one.effect.name, one.selectors): one for one in [*known.instances, *hull] if not one.groups
    }
    true = [_part(instances, effect, effect) for effect in truth["effects"]]
    if truth["hull"]:
        true += [(one, np.ones(one.size)) for one in hull]
    lines = [
        _part(instances, cause, {name: one["value"] for name, one in cause["parameters"].items()})
        for cause in causes
    ]
    continuation = continuation_of(run_set, known.weight)
    return _criterion(continuation, true) - _criterion(continuation, lines)


def _position_noise(found: Judged, sigmas: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """(6, 3) Gauss-Markov noise of the positions that an answer tells; None where they have none.

    sigmas: (6,) standard deviations that channels are weighted by.
    """
    entries = {name: one for name, one in found.get("wandering", {}).items() if name in POSITIONS}
    made = white_noise()
    for index, name in enumerate(CHANNELS):
        if name in entries:
            one = entries[name]
            made[index] = (
                one["standard_deviation"],
                one["time_constant_s"],
                found["noise"][name] / sigmas[index],
            )
    return made if entries else None


def _key(effect: str, thrusters: Sequence[str]) -> Key:
    """Of a candidate; two thrusters that are swapped have no order."""
    return effect, frozenset(thrusters)


def _part(instances: Mapping[Key, EffectInstance], effect: Judged, values: Mapping[str, float]) -> Part:
    """The candidate of an effect, and its numbers as a fit has them."""
    chosen = effect.get("thruster") or []
    instance = instances[_key(effect["effect"], [chosen] if isinstance(chosen, str) else chosen)]
    numbers = {name: values[name] for name in instance.effect.parameter_names if name in values}
    if instance.effect.vector:
        size, direction = (values[name] for name in instance.effect.vector)
        numbers |= zip(
            instance.effect.vector, (size * np.cos(direction), size * np.sin(direction)), strict=True
        )
    start = (instance.starts or instance.grid or [(0.0,) * instance.size])[0]
    given = zip(instance.effect.parameter_names, start, strict=True) if instance.size else ()
    return instance, np.array([numbers.get(name, begin) for name, begin in given])


def _criterion(continuation: Continuation, parts: Iterable[Part]) -> float:
    hypothesis, x = joined(parts)
    fit_by_continuation(continuation, hypothesis, x)
    return continuation.criterion(continuation.fit(LAST, hypothesis, x))
