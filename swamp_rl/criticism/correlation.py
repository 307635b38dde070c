"""How the errors of a diagnosis's numbers go together."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.criticism.candidates import entries_of
from swamp_rl.criticism.estimate import honest_covariance, slopes_of
from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.result import Cause
from swamp_rl.criticism.shooting import Shooting


def correlation(problem: Shooting, at: Fit, causes: Sequence[Cause]) -> list[list[float]]:
    """Correlations of the numbers of `causes`, of the fit `at`, in their order: of what their standard errors
    are the spread of. One that was not fitted goes with none.
    """
    covariance = honest_covariance(problem, at)
    slopes: dict[tuple[str, str], np.ndarray] = {}
    start = 0
    for atom, own in at.hypothesis.parts(at.x):
        selector = entries_of(atom, own)[0].thruster
        for name, slope in slopes_of(atom, own).items():
            row = np.zeros(at.hypothesis.size)
            row[start : start + atom.size] = slope
            slopes[f"{atom.effect.name} {_listed(selector)}", name] = row
        start += atom.size
    rows = [slopes[f"{cause.effect} {cause.thruster}", name] for cause in causes for name in cause.parameters]
    if not rows:
        return []
    joint = np.array(rows) @ covariance @ np.array(rows).T
    spread = np.sqrt(np.abs(np.diag(joint)))
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.clip(joint / np.outer(spread, spread), -1.0, 1.0)
    found[~np.isfinite(found)] = 0.0
    found = 0.5 * (found + found.T)
    np.fill_diagonal(found, 1.0)
    return [[float(value) for value in row] for row in found]


def _listed(selector: object) -> object:
    """As a cause has it."""
    return list(selector) if isinstance(selector, tuple) else selector
