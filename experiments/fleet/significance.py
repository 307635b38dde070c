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
from swamp_rl.experiments.fleet.labels import curve_label, is_weather, label
from swamp_rl.experiments.fleet.result import Finding, Member, SharedCause

from swamp_rl.criticism.result import Diagnosis, HeldOut

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


def findings_of(members: Sequence[Member], found: Mapping[str, Diagnosis]) -> tuple[list[Finding], int]:
    """Every confirmed cause, and how many p-values were counted."""
    tests: list[tuple[Member, str, float]] = []
    for member in members:
        if member.name not in found:
            continue
        diagnosis = found[member.name]
        own = [(label(one), p_value(one.held_out)) for one in diagnosis.standing if one.held_out]
        if diagnosis.extension and (curve := curve_label(diagnosis)):
            own.append((curve, p_value(diagnosis.extension.held_out)))
        tests += [(member, *one) for one in own or [("", 1.0)]]
    kept = (adjusted([p for _, _, p in tests]) <= RATE).tolist()
    findings = [
        Finding(name=member.name, boat=member.boat, cause=cause, p=p, kept=bool(stands))
        for (member, cause, p), stands in zip(tests, kept, strict=True)
        if cause
    ]
    return findings, len(tests)


def shared_causes(findings: Sequence[Finding]) -> list[SharedCause]:
    """Kept causes that several boats have, the most frequent first, without the weather."""
    found = _boats_of([one for one in findings if not is_weather(one.cause)])
    return [one for one in found if len(one.boats) > 1]


def weather_of(findings: Sequence[Finding]) -> list[SharedCause]:
    """Kept effects of weather, and the boats in whose datasets they are."""
    return _boats_of([one for one in findings if is_weather(one.cause)])


def _boats_of(findings: Sequence[Finding]) -> list[SharedCause]:
    """Each kept cause and its boats, the most frequent first."""
    boats = defaultdict[str, set[str]](set)
    for one in findings:
        if one.kept:
            boats[one.cause].add(one.boat)
    found = [SharedCause(cause=cause, boats=sorted(names)) for cause, names in boats.items()]
    return sorted(found, key=lambda one: (-len(one.boats), one.cause))
