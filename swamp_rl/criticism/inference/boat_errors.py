"""Errors of the boat file's own fitted numbers: in a fit's parameters, and in what it leaves of the runs."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_numbers.number import Number
from swamp_rl.boat_numbers.numbers import free_numbers, write_numbers
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import Normal, normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, inverse
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.score_test import neutral_start

Array = NDArray[np.float64]


def boat_file_covariance(problem: Shooting, at: Fit) -> Array:
    """(p, p) covariance of x by the errors of the numbers that the boat file has a `covariance` of; zeros
    where it has none.

    dx/dz = −(JᵀJ + P)⁻¹ Jᵀ K, with the sensitivities J of the predictions to x and K to the principal
    components z of these errors, initial states eliminated, and the precision P of the prior.
    """
    count = at.hypothesis.size
    if problem.boat.covariance is None or not count or not np.isfinite(at.covariance).all():
        return np.zeros((count, count))
    information = _jointly(problem, at)[0].information.sum(axis=0)
    moved_by = at.covariance @ information[:count, count:]
    return np.asarray(moved_by @ moved_by.T)


@dataclass(frozen=True)
class BesideErrors:
    """What is left of a fit if the boat file's numbers may be off by their errors.

    within: labels of its effects that these errors may stand for; adequate: whether the rest is noise, at
    errors that are not improbable.
    """

    within: frozenset[str]
    adequate: bool


def beside_boat_errors(
    problem: Shooting, at: Fit, required_gain: Callable[[Hypothesis, EffectInstance], float]
) -> BesideErrors:
    """The fit and the principal components of the boat file's errors, with their standard normal prior, in
    one step of Gauss-Newton. An effect is within the errors if chi2 rises by less without it (Wald) than the
    search requires, `required_gain` of the other effects and it.
    """
    from scipy.special import chdtri

    normal, slopes = _jointly(problem, at)
    mean, precision = at.hypothesis.prior()[0], at.hypothesis.prior_precision
    count = at.hypothesis.size
    H, g = normal.information.sum(axis=0), normal.gradient.sum(axis=0)
    H[:count, :count] += precision
    H[count:, count:] += np.eye(len(H) - count)
    g[:count] -= precision @ (at.x - mean)
    covariance = inverse(H)
    step = covariance @ g
    by_states = (at.states_jacobian @ normal.shift(step)[..., None])[..., 0]
    rest = replace(at, residual=at.residual - slopes @ step - by_states)
    within = set()
    for instance, x in at.hypothesis.parts(at.x + step[:count]):
        own = np.flatnonzero(at.hypothesis.columns(instance.label))
        away = x - np.array(neutral_start(instance, problem.boat) * instance.count)
        rise = away @ inverse(covariance[np.ix_(own, own)]) @ away
        others = Hypothesis(tuple(one for one in at.hypothesis.instances if one is not instance))
        if instance.size and rise < required_gain(others, instance):
            within.add(instance.label)
    errors = step[count:]
    probable = errors @ errors < chdtri(len(errors), options().tail)
    return BesideErrors(frozenset(within), bool(probable and adequacy(problem, rest).adequate))


def _jointly(problem: Shooting, at: Fit) -> tuple[Normal, Array]:
    """Normal equations of the parameters, then of the principal components, and the sensitivities (W, M,
    p + k) to them.
    """
    numbers, components = principal_errors(problem.boat)
    base = problem.track(at.hypothesis, at.x, at.states)
    by_errors = np.zeros((*at.residual.shape, len(components)))
    for column, error in enumerate(components):
        record = problem.record.copy()
        write_numbers(numbers, record, error[None])
        moved = problem.of_record(record).track(at.hypothesis, at.x, at.states)
        by_errors[..., column] = problem.standardised((moved - base) / options().errors_step)
    by_errors = np.where(np.isfinite(by_errors), by_errors, 0.0)  # of a boat that diverges
    by_x = parameter_jacobian(problem, at.hypothesis, at.x, at.states, base)
    slopes = np.concatenate([by_x, by_errors], axis=2)
    return normal_equations(at.states_jacobian, slopes, at.residual), slopes


def principal_errors(boat: Boat) -> tuple[list[Number], Array]:
    """Numbers (n) of the boat's `covariance`, and (n, n) what they are where each principal component of
    their errors is `errors_step`, or as much of it as the numbers' bounds allow: along a component, numbers
    that the errors hold together move together.
    """
    known = boat.covariance
    assert known is not None
    places = {number.name: number for number in free_numbers(boat, positions=True)}
    kept = [i for i, name in enumerate(known.numbers) if name in places]
    numbers = [places[known.numbers[i]] for i in kept]
    covariance = known.matrix[np.ix_(kept, kept)]
    size = np.sqrt(np.diag(covariance))
    size[size == 0.0] = 1.0  # of a number without error
    values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
    errors = (vectors * np.sqrt(np.maximum(values, 0.0))).T * size
    mean = np.array([number.mean for number in numbers])
    low, high = np.array([number.bounds for number in numbers]).reshape(-1, 2).T
    return numbers, np.clip(mean + options().errors_step * errors, low, high)
