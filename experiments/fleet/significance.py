"""P-values of causes across a fleet, and the false discovery rate that they are held at.

A cause's p-value is min(1, m exp(−g/2)): g is the fall of chi2 on runs that its parameters were not fitted
to, so that exp(g/2) is a split likelihood ratio, whose mean is at most one where there is no such cause
(Wasserman, Ramdas and Balakrishnan 2020, 10.1073/pnas.1922664117); m is the number of comparisons of its
diagnosis (Bonferroni). A dataset without a cause counts as one test with p = 1.
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.fleet.result import Change, Drift, Finding, Member, SharedCause

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate, HeldOut

RATE = 0.05


def p_value(held_out: HeldOut) -> float:
    """Of a cause from its confirmation."""
    comparisons = 0.05 / max(1.0 - held_out.level, 1e-12)
    return min(1.0, comparisons * math.exp(-0.5 * max(held_out.gain, 0.0)))


def adjusted(p: Sequence[float]) -> NDArray[np.float64]:
    """(n,) p-values adjusted so that those at most q are kept at the false discovery rate q (Benjamini and
    Hochberg 1995).
    """
    from scipy.stats import false_discovery_control

    return np.asarray(false_discovery_control(p) if len(p) else p, dtype=float)


def label(cause: Cause) -> str:
    """Effect and thrusters."""
    thruster = cause.thruster if isinstance(cause.thruster, list) else [cause.thruster or ""]
    return " ".join((cause.effect, *thruster)).strip()


def findings_of(members: Sequence[Member], found: Mapping[str, Diagnosis]) -> tuple[list[Finding], int]:
    """Every confirmed cause, and how many p-values were counted."""
    tests: list[tuple[Member, str, float]] = []
    for member in members:
        if member.name not in found:
            continue
        diagnosis = found[member.name]
        own = [(label(one), p_value(one.held_out)) for one in diagnosis.causes if one.held_out]
        if diagnosis.extension and diagnosis.extension.written:
            curves = " and ".join(f"{one.component} of {one.covariate}" for one in diagnosis.extension.curves)
            own.append((f"force_curve {curves}", p_value(diagnosis.extension.held_out)))
        tests += [(member, *one) for one in own or [("", 1.0)]]
    kept = (adjusted([p for _, _, p in tests]) <= RATE).tolist()
    findings = [
        Finding(name=member.name, boat=member.boat, cause=cause, p=p, kept=bool(stands))
        for (member, cause, p), stands in zip(tests, kept, strict=True)
        if cause
    ]
    return findings, len(tests)


def shared_causes(findings: Sequence[Finding]) -> list[SharedCause]:
    """Kept causes that several boats have, the most frequent first."""
    boats = defaultdict[str, set[str]](set)
    for one in findings:
        if one.kept:
            boats[one.cause].add(one.boat)
    found = [SharedCause(cause=cause, boats=sorted(names)) for cause, names in boats.items()]
    return sorted((one for one in found if len(one.boats) > 1), key=lambda one: (-len(one.boats), one.cause))


def changes_of(
    members: Sequence[Member], found: Mapping[str, Diagnosis], findings: Sequence[Finding]
) -> tuple[list[Drift], list[Change]]:
    """Differences between the datasets of one boat: parameters of its kept causes, and the causes."""
    kept = {(one.name, one.cause) for one in findings if one.kept}
    of_boat = defaultdict[str, list[str]](list)
    for member in members:
        if member.name in found:
            of_boat[member.boat].append(member.name)
    drifts: list[Drift] = []
    changes: list[Change] = []
    for boat, names in sorted(of_boat.items()):
        for cause in sorted({cause for name, cause in kept if name in names}):
            has = [name for name in names if (name, cause) in kept]
            absent = [name for name in names if name not in has]
            if absent:
                changes.append(Change(boat=boat, cause=cause, found_in=has, absent_in=absent))
            drifts += _drifts(boat, cause, {name: found[name] for name in has})
    held = adjusted([one.p for one in drifts])
    kept_drifts = [one.model_copy(update={"p": p}) for one, p in zip(drifts, held.tolist(), strict=True)]
    return [one for one in kept_drifts if one.p <= RATE], changes


def _drifts(boat: str, cause: str, diagnoses: Mapping[str, Diagnosis]) -> list[Drift]:
    """A cause's parameters compared between diagnoses by name, with p-values that are not adjusted."""
    causes = {
        name: next((one for one in diagnosis.causes if label(one) == cause), None)
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
