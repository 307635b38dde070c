"""What a fleet's report takes from the diagnosis of each dataset, and from all datasets of a boat."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from swamp_rl.experiments.fleet.labels import curve_label, is_weather, label, named_in
from swamp_rl.experiments.fleet.result import (
    BoatCauses,
    Finding,
    Member,
    MemberCause,
    PositionError,
    SharedCause,
)

from swamp_rl.boat import load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.criticism.report.evidence import predictors_sentence
from swamp_rl.criticism.result import Cause, Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.runs.dataset import own_boat

FEWEST = 3
"""Boats of which most may tell an error of their boat file from faults of their own."""


def summarised(members: Sequence[Member], found: Mapping[str, Diagnosis]) -> list[Member]:
    """The members with what their diagnoses found; those without a diagnosis as they are."""
    errors = _position_errors(found)
    return [
        one.model_copy(update=_taken(found[one.name], errors[one.name])) if one.name in found else one
        for one in members
    ]


def _taken(diagnosis: Diagnosis, error: PositionError | None) -> dict[str, object]:
    causes = [_cause(one) for one in diagnosis.standing]
    if curve := curve_label(diagnosis):
        causes.append(MemberCause(cause=curve))
    return {
        "verdict": diagnosis.verdict,
        "causes": causes,
        "minor": [_cause(one) for one in diagnosis.minor],
        "indistinguishable": diagnosis.indistinguishable,
        "position_error": error,
        "warning": predictors_sentence(diagnosis) or None,
    }


def _cause(one: Cause) -> MemberCause:
    name = label(one)
    scope = one.scope if one.groups else "boat"
    return MemberCause(cause=name, weather=is_weather(name), scope=scope, parameters=one.parameters)


def _position_errors(found: Mapping[str, Diagnosis]) -> dict[str, PositionError | None]:
    """By name, the error at the longest horizon that all have, or without one at the longest of each."""
    errors = {name: _by_horizon(one) for name, one in found.items()}
    common = set.intersection(*map(set, errors.values())) if errors else set()
    return {name: own[max(common or own)] if own else None for name, own in errors.items()}


def _by_horizon(diagnosis: Diagnosis) -> dict[float, PositionError]:
    return {
        one.horizon_s: PositionError(
            horizon_s=one.horizon_s, before=one.position_rmse_m.before, after=one.position_rmse_m.after
        )
        for one in diagnosis.gain
        if one.position_rmse_m
    }


def boats_of(members: Sequence[Member], findings: Sequence[Finding]) -> list[BoatCauses]:
    """The boats that have a diagnosis: those with causes of their own, with lesser ones only, with none."""
    refused = {(one.name, one.cause) for one in findings if not one.kept}
    causes: dict[str, set[str]] = {}
    lesser: dict[str, set[str]] = {}
    for member in members:
        if member.verdict is None:
            continue
        own = {one.cause for one in member.causes if not one.weather}
        kept = {cause for cause in own if (member.name, cause) not in refused}
        minor = {one.cause for one in member.minor if not one.weather}
        causes.setdefault(member.boat, set()).update(kept)
        lesser.setdefault(member.boat, set()).update(minor | own - kept)
    boats = [
        BoatCauses(boat=boat, causes=sorted(own), lesser=sorted(lesser[boat] - own))
        for boat, own in causes.items()
    ]
    return sorted(boats, key=lambda one: (not one.causes, not one.lesser, one.boat))


def of_boat_file(
    shared: Sequence[SharedCause], members: Sequence[Member], found: Mapping[str, Diagnosis]
) -> list[SharedCause]:
    """The shared causes, those marked that are rather errors of the one boat file of all: no boat is healthy
    in which such an error would show too.
    """
    diagnosed = [one for one in members if one.verdict]
    boats = len({one.boat for one in diagnosed})
    most = [
        boats >= FEWEST
        and len(one.boats) > boats / 2
        and not any(
            _denies(one.cause, found[other.name]) for other in diagnosed if other.boat not in one.boats
        )
        for one in shared
    ]
    one_file = any(most) and _same_boat_file(diagnosed)
    return [
        one.model_copy(update={"in_boat_file": many and one_file})
        for one, many in zip(shared, most, strict=True)
    ]


def _denies(cause: str, diagnosis: Diagnosis) -> bool:
    """Whether a diagnosis explains its runs without a cause that these would show."""
    possible = named_in(diagnosis).union(diagnosis.unseen, diagnosis.hidden)
    return diagnosis.verdict != "unexplained" and cause not in possible


def _same_boat_file(members: Sequence[Member]) -> bool:
    """Whether all datasets were compared with the same numbers."""
    try:
        files = {one.boat_file or own_boat(Path(one.dataset)) for one in members}
        return len({boat_digest(load_boat(file)) for file in files}) == 1
    except (UserError, OSError):
        return False
