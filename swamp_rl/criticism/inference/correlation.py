"""Correlation of the errors of a diagnosis's parameters."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.criticism.inference.estimate import slopes_of
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.likelihood.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.model.candidates import entries_of
from swamp_rl.criticism.result import Cause


def correlation(problem: Shooting, at: Fit, causes: Sequence[Cause]) -> list[list[float]]:
    """Correlation matrix of the parameters of `causes`, in their order, from the sandwich covariance of the
    fit `at`. A parameter without variance has no correlation.
    """
    covariance = sandwich_covariance(problem, at)
    slopes: dict[tuple[str, str], np.ndarray] = {}
    for instance, own in at.hypothesis.parts(at.x):
        mean = instance.by_group(own).mean(axis=0)
        selector = entries_of(instance.of_one, mean)[0].thruster
        for name, slope in slopes_of(instance.of_one, mean).items():
            row = np.zeros(at.hypothesis.size)
            row[at.hypothesis.columns(instance.label)] = np.tile(slope, instance.count) / instance.count
            slopes[f"{instance.effect.name} {_listed(selector)}", name] = row
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
    """A selector as a cause has it."""
    return list(selector) if isinstance(selector, tuple) else selector
