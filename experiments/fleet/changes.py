"""What differs between the datasets of one boat: its kept causes, and their parameters."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from swamp_rl.experiments.fleet.labels import indistinguishable_from, is_weather, label, named_in
from swamp_rl.experiments.fleet.result import Change, Drift, Finding, Member
from swamp_rl.experiments.fleet.significance import RATE, adjusted

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.result import Diagnosis, Estimate


def changes_of(
    members: Sequence[Member], found: Mapping[str, Diagnosis], findings: Sequence[Finding]
) -> tuple[list[Drift], list[Change]]:
    """Differences between the datasets of one boat: parameters of its kept causes, minor estimates too, and
    the causes. Weather is none of the boat's.
    """
    kept = {(one.name, one.cause) for one in findings if one.kept and not is_weather(one.cause)}
    of_boat = defaultdict[str, list[str]](list)
    for member in members:
        if member.name in found:
            of_boat[member.boat].append(member.name)
    drifts: list[Drift] = []
    changes: list[Change] = []
    for boat, names in sorted(of_boat.items()):
        own = {name: found[name] for name in names}
        for cause in sorted({cause for name, cause in kept if name in own}):
            has = [name for name in names if (name, cause) in kept]
            absent = _absent_in(cause, has, own)
            if absent:
                changes.append(Change(boat=boat, cause=cause, found_in=has, absent_in=absent))
            drifts += _drifts(boat, cause, own)
    held = adjusted([one.p for one in drifts])
    kept_drifts = [one.model_copy(update={"p": p}) for one, p in zip(drifts, held.tolist(), strict=True)]
    return [one for one in kept_drifts if one.p <= RATE], changes


def _absent_in(cause: str, has: Sequence[str], diagnoses: Mapping[str, Diagnosis]) -> list[str]:
    """The datasets that name neither a cause nor what those that have it cannot distinguish it from."""
    equal = set[str]().union(*(indistinguishable_from(cause, diagnoses[name]) for name in has))
    return [name for name, one in diagnoses.items() if name not in has and not equal & named_in(one)]


def _drifts(boat: str, cause: str, diagnoses: Mapping[str, Diagnosis]) -> list[Drift]:
    """A cause's parameters compared between diagnoses by name, with p-values that are not adjusted."""
    causes = {
        name: next((one for one in (*diagnosis.standing, *diagnosis.minor) if label(one) == cause), None)
        for name, diagnosis in diagnoses.items()
    }
    parameters = dict.fromkeys(name for one in causes.values() if one for name in one.parameters)
    made = []
    for parameter in parameters:
        estimates = {name: one.parameters.get(parameter) for name, one in causes.items() if one}
        known = {name: one for name, one in estimates.items() if one and one.identifiable}
        made.append(_drift(boat, cause, parameter, known))
    return [one for one in made if one]


def _drift(boat: str, cause: str, parameter: str, estimates: Mapping[str, Estimate]) -> Drift | None:
    """The estimates compared; None where they are fewer than two, or one has no finite standard error."""
    from scipy.special import chdtrc

    errors = {name: one.standard_error for name, one in estimates.items()}
    values = {name: one.value for name, one in estimates.items()}
    if len(values) < 2 or any(one.at_bound for one in estimates.values()):
        return None
    if not np.isfinite([*errors.values(), *values.values()]).all() or min(errors.values()) <= 0.0:
        return None
    unit = next(iter(estimates.values())).unit
    q = heterogeneity(list(values.values()), list(errors.values()), unit == "rad")
    if math.isnan(q):
        return None  # of values beyond floating-point arithmetic
    return Drift(
        boat=boat,
        cause=cause,
        parameter=parameter,
        unit=unit,
        values=values,
        standard_errors=errors,
        p=float(chdtrc(len(values) - 1, q)),
    )


@np.errstate(over="ignore", invalid="ignore")
def heterogeneity(values: Sequence[float], errors: Sequence[float], angle: bool = False) -> float:
    """Cochran's Q: the weighted sum of squared differences from the weighted mean; angles the short way.

    inf where it is too large for a float, nan where the differences are.
    """
    error = np.asarray(errors, dtype=float)
    weight = (error.min() / error) ** 2
    away = np.asarray(values, dtype=float) - values[0]
    if angle:
        away = within_half_turn(away)
    mean = float(weight @ away) / float(weight.sum())
    return float((((away - mean) / error) ** 2).sum())
