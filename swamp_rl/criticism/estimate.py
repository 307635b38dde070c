"""The winner's numbers with their standard errors, in the effects' own terms."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Atom, entries_of
from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.result import Cause, Estimate

Array = NDArray[np.float64]


def causes_of(at: Fit) -> list[Cause]:
    """Every atom of a fit as a cause."""
    covariance = at.covariance
    causes = []
    start = 0
    for atom, own in at.hypothesis.parts(at.x):
        block = covariance[start : start + atom.size, start : start + atom.size]
        causes.append(_cause(atom, own, block))
        start += atom.size
    return causes


def _cause(atom: Atom, x: Array, covariance: Array) -> Cause:
    entry = entries_of(atom, x)[0]
    selector: Any = entry.thruster
    values = {name: float(value) for name, value in entry.values.items()}
    slopes = _slopes(atom, x, values)
    parameters = {
        name: Estimate(
            value=value,
            standard_error=float(np.sqrt(abs(slopes[name] @ covariance @ slopes[name]))),
            unit=atom.effect.parameter(name).unit,
        )
        for name, value in values.items()
    }
    thruster = list(selector) if isinstance(selector, tuple) else selector
    return Cause(effect=atom.effect.name, thruster=thruster, parameters=parameters)


def _slopes(atom: Atom, x: Array, values: dict[str, float]) -> dict[str, Array]:
    """Of each of the effect's parameters by the fitted numbers: the identity, save where they are a
    vector's.
    """
    slopes = {name: np.zeros(len(x)) for name in values}
    for i, spec in enumerate(atom.specs):
        moved = x.copy()
        moved[i] += 1e-6 * spec.scale
        for name, value in entries_of(atom, moved)[0].values.items():
            slopes[name][i] = (float(value) - values[name]) / (1e-6 * spec.scale)
    return slopes
