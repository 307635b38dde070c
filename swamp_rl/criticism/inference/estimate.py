"""Parameter estimates and their standard errors, in the effects' own parameters."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.inference.unidentifiable import undetermined
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance, entry_of
from swamp_rl.criticism.nuisance.random_effect import random_effect
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Cause, Estimate, Limit, Spread

Array = NDArray[np.float64]


def causes_of(problem: Shooting, at: Fit) -> list[Cause]:
    """Every named effect of a fit as a cause."""
    covariance = sandwich_covariance(problem, at)
    named = [(one, x, at.hypothesis.columns(one.label)) for one, x in at.parts() if not one.curve]
    return [_cause(one, x, covariance[np.ix_(own, own)], problem.run_set) for one, x, own in named]


def _cause(instance: EffectInstance, x: Array, covariance: Array, run_set: RunSet) -> Cause:
    """Of x (p,) with covariance (p, p). Where groups of runs have parameters of their own, those of the cause
    are the mean of the distribution that they are drawn from, and `spread` is its standard deviation.
    """
    one = instance.of_one
    if not instance.groups:
        return cause_of(one, x, covariance)
    values = instance.by_group(x)
    scale = one.scales
    drawn = random_effect(values, covariance, scale)
    found = cause_of(one, drawn.mean, drawn.covariance)
    found.scope = "day" if instance.by == "day" else "run"
    found.spread = {
        name: Spread(value=drawn.spread * size, low=drawn.low * size, high=drawn.high * size, unit=unit)
        for (name, unit), size in zip(components(one), scale, strict=True)
    }
    blocks = covariance.reshape(instance.count, one.size, instance.count, one.size)
    found.groups = {
        name: _estimates(one, own, blocks[number, :, number])
        for number, (name, own) in enumerate(zip(run_set.group_names(instance.by), values, strict=True))
    }
    return found


def cause_of(instance: EffectInstance, x: Array, covariance: Array) -> Cause:
    """The cause whose parameters all runs share, from x (p,) with covariance (p, p)."""
    selector: Any = entry_of(instance, x).thruster
    return Cause(
        effect=instance.effect.name,
        thruster=list(selector) if isinstance(selector, tuple) else selector,
        parameters=_estimates(instance, x, covariance),
    )


def components(instance: EffectInstance) -> list[tuple[str, str]]:
    """Name and unit of each fitted parameter; a vector's are its components to the north and east."""
    names = list(instance.effect.parameter_names)
    units = [instance.effect.parameter(name).unit for name in names]
    if instance.effect.vector:
        size, direction = (names.index(name) for name in instance.effect.vector)
        units[direction] = units[size]
        names[size], names[direction] = "north", "east"
    return list(zip(names, units, strict=True))


def _estimates(instance: EffectInstance, x: Array, covariance: Array) -> dict[str, Estimate]:
    """The effect's parameters from x (p,) with covariance (p, p)."""
    slopes = slopes_of(instance, x)
    sides, unknown = sides_of(instance, x), undetermined(instance, covariance)
    return {
        name: Estimate(
            value=float(value),
            standard_error=float(np.sqrt(abs(slopes[name] @ covariance @ slopes[name]))),
            unit=instance.effect.parameter(name).unit,
            at_bound=bool((slopes[name] * sides).any()),
            limit=_limit(slopes[name] * sides),
            identifiable=not (slopes[name] * unknown).any(),
        )
        for name, value in instance.values(x).items()
    }


def sides_of(instance: EffectInstance, x: Array) -> Array:
    """(p,) -1 for each parameter at its lower bound, 1 at its upper one, 0 in between."""
    room = options().at_bound * instance.scales
    low, high = np.array([s.low for s in instance.specs]), np.array([s.high for s in instance.specs])
    return np.asarray((x >= high - room).astype(float) - (x <= low + room))


def _limit(outwards: Array) -> Limit | None:
    """The side on which a parameter is bounded, from its derivatives (p,) by the numbers at bounds."""
    ways = set(np.sign(outwards[outwards != 0.0]))
    return ("at_least" if ways == {1.0} else "at_most") if len(ways) == 1 else None


def slopes_of(instance: EffectInstance, x: Array) -> dict[str, Array]:
    """Derivatives (p,) of each of the effect's parameters by the fitted ones."""
    values = instance.values(x)
    slopes = {name: np.zeros(len(x)) for name in values}
    for i, spec in enumerate(instance.specs):
        moved = x.copy()
        moved[i] += 1e-6 * spec.scale
        for name, value in instance.values(moved).items():
            slopes[name][i] = (value - values[name]) / (1e-6 * spec.scale)
    return slopes


def correlation(problem: Shooting, at: Fit, causes: Sequence[Cause]) -> list[list[float]]:
    """Correlation of the parameters of `causes`, 0 where one has no variance; sandwich covariance of `at`."""
    covariance = sandwich_covariance(problem, at)
    slopes: dict[tuple[str, str], Array] = {}
    for instance, own in at.parts():
        mean = instance.by_group(own).mean(axis=0)
        for name, slope in slopes_of(instance.of_one, mean).items():
            row = slopes[instance.label, name] = np.zeros(at.hypothesis.size)
            row[at.hypothesis.columns(instance.label)] = np.tile(slope, instance.count) / instance.count
    rows = [slopes[cause.label, name] for cause in causes for name in cause.parameters]
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
