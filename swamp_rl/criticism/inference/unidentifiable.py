"""Parameters of a named cause that the runs say nothing about: they keep the value that changes nothing."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.likelihood.output_error import Fit, at_states
from swamp_rl.criticism.model.candidates import EffectInstance
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.criticism.selection.score_test import neutral_start

Array = NDArray[np.float64]


def with_neutral_values(continuation: Continuation, found: Selection) -> Selection:
    """The selection, and its rivals, with every unidentifiable parameter at its neutral value, so that no
    value is reported or written that nothing was measured of: a drag astern of a boat that never went astern.
    """
    winner, *rivals = (_neutral(continuation, one, found.stage) for one in (found.winner, *found.rivals))
    return replace(found, winner=winner, rivals=rivals)


def _neutral(continuation: Continuation, at: Fit, stage: int) -> Fit:
    problem = continuation.problem(stage, at.hypothesis)
    covariance, x = sandwich_covariance(problem, at), at.x.copy()
    for instance, own in at.parts():
        mine = at.hypothesis.columns(instance.label)
        unknown = unidentifiable(instance, covariance[np.ix_(mine, mine)])
        x[mine] = np.where(unknown, neutral_start(instance, problem.boat) * instance.count, own)
    if np.array_equal(x, at.x):
        return at
    made = at_states(problem, at.hypothesis, x, at.states, options().score_rounds)
    if made.chi2 > at.chi2 + options().clearly:
        return at
    continuation.keep(stage, problem, made)
    return made


def unidentifiable(instance: EffectInstance, covariance: Array) -> NDArray[np.bool_]:
    """(p,) whether the variance of a parameter exceeds a share of the squared range that a fit may search;
    none where that of all does, or where the parameters are components of one quantity. covariance: (p, p).
    """
    unknown = _exceeds_range(instance, options().least_information * covariance)
    return np.zeros(instance.size, dtype=bool) if unknown.all() else unknown


def undetermined(instance: EffectInstance, covariance: Array) -> NDArray[np.bool_]:
    """(p,) the unidentifiable parameters, and those whose standard error exceeds all of the range that a fit
    may search: of an explanation that these runs do not distinguish from another, that may be all of them.
    """
    return unidentifiable(instance, covariance) | _exceeds_range(instance, covariance)


def _exceeds_range(instance: EffectInstance, covariance: Array) -> NDArray[np.bool_]:
    """(p,) whether a variance exceeds the squared range of a fit; none of components of one quantity."""
    together = instance.effect.vector or instance.effect.half_turn or instance.groups or instance.curve
    reach = np.array([spec.high - spec.low for spec in instance.specs])
    return np.zeros(instance.size, dtype=bool) if together else np.diag(covariance) > reach**2
