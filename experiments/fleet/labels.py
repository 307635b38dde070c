"""Labels of causes, by which a fleet compares the diagnoses of its datasets."""

from collections.abc import Iterable, Sequence

from swamp_rl.criticism.report.words import DIFFERS
from swamp_rl.criticism.result import Cause, Diagnosis
from swamp_rl.effects import LIBRARY


def label(cause: Cause) -> str:
    """Effect and thrusters."""
    thruster = cause.thruster if isinstance(cause.thruster, list) else [cause.thruster or ""]
    return " ".join((cause.effect, *thruster)).strip()


def curve_label(diagnosis: Diagnosis) -> str | None:
    """The force that no named effect explains, if it is in the extended boat."""
    extension = diagnosis.extension
    if extension is None or not extension.written:
        return None
    return "force_curve " + " and ".join(f"{one.component} of {one.covariate}" for one in extension.curves)


def is_weather(label: str) -> bool:
    """Whether an effect is none of the boat's."""
    effect = LIBRARY.get(label.split(maxsplit=1)[0])
    return effect is not None and effect.weather


def indistinguishable_from(cause: str, diagnosis: Diagnosis) -> set[str]:
    """A cause of a diagnosis and those, but the weather, that equivalent explanations have in its place."""
    found = {cause}
    for explanations in diagnosis.indistinguishable:
        differing = _differing(explanations)
        if cause in differing:
            found |= {one for one in differing if not is_weather(one)}
    return found


def explanations_with(cause: str, indistinguishable: Sequence[Sequence[str]]) -> tuple[int, int]:
    """How many of how many equivalent explanations have a cause; of several sets, those of the lowest share;
    (1, 1) where all have it."""
    sets = [one for one in indistinguishable if cause in _differing(one)]
    counts = [(sum(cause in _labels(each) for each in one), len(one)) for one in sets]
    return min(counts, key=_share, default=(1, 1))


def least_doubtful(counts: Iterable[tuple[int, int]]) -> tuple[int, int]:
    """Of several `explanations_with`, those of the highest share; (1, 1) where there is none."""
    return max(counts, key=_share, default=(1, 1))


def _share(counts: tuple[int, int]) -> float:
    return counts[0] / counts[1]


def _differing(explanations: Sequence[str]) -> set[str]:
    """The causes that not all of equivalent explanations have."""
    sets = [_labels(one) for one in explanations]
    return set[str]().union(*sets) - sets[0].intersection(*sets)


def named_in(diagnosis: Diagnosis) -> set[str]:
    """All causes of a diagnosis, with minor ones, those of equivalent explanations and a force curve."""
    own = {label(one) for one in (*diagnosis.causes, *diagnosis.minor)}
    own |= {curve} if (curve := curve_label(diagnosis)) else set()
    return own.union(*(_labels(one) for explanations in diagnosis.indistinguishable for one in explanations))


def _labels(explanation: str) -> set[str]:
    """The labels of a set of effects: `current` and `mass` of `current by_run + mass`."""
    parts = (one.split() for one in explanation.split(" + "))
    return {" ".join(word for word in part if word not in DIFFERS) for part in parts}
