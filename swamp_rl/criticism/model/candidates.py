"""Candidate causes: every effect of the library on every thruster, with the parameters of its fit."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.boat import Boat
from swamp_rl.boat.applicable import able
from swamp_rl.boat.quantity import value_at
from swamp_rl.criticism.options import options
from swamp_rl.effects import LIBRARY, Effect, EffectEntry, Parameter, Reference, apply_effects
from swamp_rl.effects.curve import Curve
from swamp_rl.simulator import parameters
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]
Values = dict[str, Any]

ONE_RUN = np.zeros(1, dtype=np.int64)


@dataclass(frozen=True)
class Spec:
    """A `Search` of one parameter for one boat, in the parameter's unit; mean: of its prior; is_time: whether
    it is a time, at each whole step of which the likelihood has a kink.
    """

    scale: float
    low: float
    high: float
    starts: tuple[float, ...]
    difference: float
    prior: float | None = None
    mean: float = 1.0
    is_time: bool = False


@dataclass(frozen=True)
class EffectInstance:
    """One candidate: an effect, the thrusters that it acts on, and the parameters x (p,) that a fit
    estimates.

    starts: points that a fit begins from; grid: points that are only evaluated, the best of them being a
    start; groups: the group of each run, from 0 on, where every group has parameters of its own (group after
    group in x), none where all runs share them; by: what a group is. Starts and grid are of one group.
    curve: of an effect that has one, whose values x are. contains: labels of the instances that are this one
    with some of its parameters equal or neutral.
    """

    effect: Effect
    selectors: tuple[str, ...]
    specs: tuple[Spec, ...]
    starts: tuple[tuple[float, ...], ...]
    grid: tuple[tuple[float, ...], ...] = ()
    groups: tuple[int, ...] = ()
    by: str = ""
    curve: Curve | None = None
    contains: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Name, thrusters and what it differs by; unique among candidates."""
        more = [f"by_{self.by}"] if self.groups else []
        if self.curve:
            more = [self.curve.component, self.curve.covariate, self.curve.formula or "points"]
        return " ".join((self.effect.name, *self.selectors, *more))

    @property
    def of_boat(self) -> bool:
        """Whether it belongs to the boat and is the same in every run."""
        return not (self.effect.weather or self.groups)

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.specs)

    @property
    def scales(self) -> Array:
        """(p,) typical sizes of the parameters."""
        return np.array([spec.scale for spec in self.specs])

    @property
    def count(self) -> int:
        """Number of groups, 1 where all runs share the parameters."""
        return max(self.groups, default=0) + 1

    @property
    def of_one(self) -> "EffectInstance":
        """The instance of one group."""
        return replace(self, specs=self.specs[: self.size // self.count], groups=())

    def by_group(self, x: Array) -> Array:
        """(..., G, q) the parameters of each group, from x (..., p)."""
        return x.reshape(*x.shape[:-1], self.count, self.size // self.count)

    @property
    def moves_actuators(self) -> bool:
        """Whether the effect changes the actuators' motion, not only the forces that they exert."""
        return self.effect.acts_on == "command" or self.effect.moves_actuators

    def values(self, x: Array) -> Values:
        """The effect's parameters, from x (..., p): a vector's components as its size and direction.

        Of the two ways to say the same harmonic, the one with |phase| <= pi/2.
        """
        names = self.curve.value_names if self.curve else self.effect.parameter_names
        values = dict(zip(names, np.moveaxis(x, -1, 0), strict=True))
        if self.effect.vector:
            size, direction = self.effect.vector
            first, second = values[size], values[direction]
            values[size], values[direction] = np.hypot(first, second), np.arctan2(second, first)
        if self.effect.half_turn:
            direction, phase = self.effect.half_turn
            turned = values[direction] + np.pi * (np.cos(values[phase]) < 0.0)
            values[direction] = within_half_turn(turned)
            values[phase] = np.arctan(np.tan(values[phase]))
        return values


@dataclass(frozen=True)
class Hypothesis:
    """Effects that act together; no effect: the boat file alone."""

    instances: tuple[EffectInstance, ...] = ()

    @property
    def specs(self) -> tuple[Spec, ...]:
        """Of all parameters, effect after effect."""
        return tuple(spec for instance in self.instances for spec in instance.specs)

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.specs)

    @property
    def scales(self) -> Array:
        """(p,) typical sizes of the parameters."""
        return np.array([spec.scale for spec in self.specs])

    @property
    def label(self) -> str:
        """Labels of the effects, joined by plus signs."""
        return " + ".join(instance.label for instance in self.instances) or "nothing"

    @property
    def cause_label(self) -> str:
        """Label without the hull's derivatives, a nuisance, unless there is no other effect."""
        named = [instance.label for instance in self.instances if not instance.effect.nuisance]
        return " + ".join(named) or self.label

    @property
    def differs(self) -> bool:
        """Whether an effect has parameters for each group of runs."""
        return any(instance.groups for instance in self.instances)

    def of_run(self, x: Array, run: int) -> tuple["Hypothesis", Array, NDArray[np.bool_]]:
        """The hypothesis for one run alone, its parameters from x (p,), and which of x they are."""
        instances, columns = [], []
        for instance in self.instances:
            group = instance.groups[run] if instance.groups else 0
            mine = np.arange(instance.count) == group
            columns.append(np.repeat(mine, instance.size // instance.count))
            instances.append(instance.of_one)
        chosen = np.concatenate([np.zeros(0, dtype=bool), *columns])
        return Hypothesis(tuple(instances)), x[chosen], chosen

    def shared(self, x: Array) -> tuple["Hypothesis", Array]:
        """What all runs share, and its parameters from x (p,)."""
        return joined((instance, own) for instance, own in self.parts(x) if not instance.groups)

    @property
    def moves_actuators(self) -> bool:
        """Whether an effect changes the actuators' motion."""
        return any(instance.moves_actuators for instance in self.instances)

    def with_instance(self, instance: EffectInstance) -> "Hypothesis":
        """This hypothesis and one more effect, sorted by label, so that equal sets are equal."""
        return Hypothesis(tuple(sorted((*self.instances, instance), key=lambda one: one.label)))

    def of_actuators(self, x: Array) -> Array:
        """(V, p) the numbers x (V, p), those that do not move the actuators at one value."""
        return x

    def without(self, label: str) -> "Hypothesis":
        """This hypothesis less the effect of that label, and less what changes nothing without it."""
        rest = Hypothesis(tuple(instance for instance in self.instances if instance.label != label))
        return Hypothesis(tuple(instance for instance in rest.instances if rest.is_beside(instance)))

    def is_beside(self, instance: EffectInstance) -> bool:
        """Whether it has the effect without which the instance changes nothing, if there is one."""
        return instance.effect.beside in ("", *(one.effect.name for one in self.instances))

    def bounds(self) -> tuple[Array, Array]:
        """(p,) lower and (p,) upper bounds."""
        return np.array([s.low for s in self.specs]), np.array([s.high for s in self.specs])

    def prior(self) -> tuple[Array, Array]:
        """(p,) mean and (p,) precision of the Gaussian prior, 0 where there is none."""
        precision = np.array([0.0 if s.prior is None else s.prior**-2 for s in self.specs])
        return np.array([s.mean for s in self.specs]), precision

    @property
    def prior_precision(self) -> Array:
        """(p, p) inverse covariance of the Gaussian prior."""
        return np.diag(self.prior()[1])

    def parts(self, x: Array) -> list[tuple[EffectInstance, Array]]:
        """Each effect with its own columns of x (..., p)."""
        ends = list(itertools.accumulate((instance.size for instance in self.instances), initial=0))
        return [(instance, x[..., ends[i] : ends[i + 1]]) for i, instance in enumerate(self.instances)]

    def columns(self, label: str) -> NDArray[np.bool_]:
        """(p,) whether a parameter is of the effect of that label."""
        return np.array([one.label == label for one in self.instances for _ in one.specs], dtype=bool)

    def entries(self, x: Array) -> list[EffectEntry]:
        """The effects with their parameters; x: (p,) or (V, p) for V boats."""
        return [entry_of(instance, own) for instance, own in self.parts(x)]

    def records(
        self, boat: Boat, x: Array, plain: NDArray[Any] | None = None, runs: NDArray[np.int64] = ONE_RUN
    ) -> NDArray[Any]:
        """(V W,) parameter records of the boat with x (V, p) in the runs (W,), run after run; plain: (1,) the
        boat file's record, computed where None.
        """
        record = parameters(boat) if plain is None else plain
        if not self.differs:
            made = np.repeat(record, len(x))
            apply_effects(made, self.entries(x), boat.thruster_names)
            return np.repeat(made, len(runs))
        made = np.repeat(record, len(x) * len(runs))
        entries: list[EffectEntry] = []
        for instance, own in self.parts(x):
            groups = np.array(instance.groups)[runs] if instance.groups else np.zeros(len(runs), dtype=int)
            rows = instance.by_group(own)[:, groups].reshape(len(made), -1)
            entries.append(entry_of(instance.of_one, rows))
        apply_effects(made, entries, boat.thruster_names)
        return made


def joined(parts: Iterable[tuple[EffectInstance, Array]]) -> tuple[Hypothesis, Array]:
    """The hypothesis of some effects, sorted by label, and their parameters (p,) in that order."""
    every = sorted(parts, key=lambda one: one[0].label)
    return Hypothesis(tuple(one for one, _ in every)), np.concatenate([np.zeros(0), *(x for _, x in every)])


def entry_of(instance: EffectInstance, x: Array) -> EffectEntry:
    """The entry of one effect instance; x: (..., p)."""
    own = instance.selectors
    thruster = own if instance.effect.swaps else own[0] if own else None
    return EffectEntry(instance.effect, thruster, instance.values(x), instance.curve)  # type: ignore[arg-type]


def candidates(
    boat: Boat, duration: float, groups: Mapping[str, tuple[int, ...]] | None = None
) -> list[EffectInstance]:
    """Every effect instance for a boat; duration [s] of the longest run; groups: of each run, by `day` or
    `run`, between which an effect of that scope may differ.
    """
    causes = [effect for effect in LIBRARY.values() if effect.begin is not None and not effect.nuisance]
    shared = [instance for effect in causes for instance in instances_of(effect, boat, duration)]
    return shared + [
        differing(one, by, of_runs)
        for by, of_runs in (groups or {}).items()
        for one in shared
        if may_differ(one.effect, by) and 0 < max(of_runs) < options().most_groups
    ]


def may_differ(effect: Effect, by: str) -> bool:
    """Whether an effect may have other parameters in each group; `by`: `day` or `run`."""
    narrow = effect.scope in ("day", "run") if by == "day" else effect.scope == "run"
    return (
        narrow
        and effect.begin in ("score", "grid")
        and len(effect.parameters) <= options().most_group_parameters
    )


def differing(instance: EffectInstance, by: str, groups: tuple[int, ...]) -> EffectInstance:
    """An effect instance with parameters for each group; groups: of each run, from 0 on."""
    return replace(instance, specs=instance.specs * (max(groups) + 1), groups=groups, by=by)


def instances_of(effect: Effect, boat: Boat, duration: float | None = None) -> list[EffectInstance]:
    """An effect on each choice of thrusters, its `search` scaled by the boat's reference quantities."""
    chosen = selectors(effect, boat)
    if not chosen:
        return []
    reference = replace(reference_of(boat), run=options().duration if duration is None else duration)
    specs = tuple(spec_of(effect, parameter, boat, reference) for parameter in effect.parameters)
    points = tuple(itertools.product(*(spec.starts for spec in specs)))
    if effect.vector and effect.begin == "grid":
        points = tuple(
            (size * math.cos(angle), size * math.sin(angle))
            for size in specs[0].starts
            for angle in np.arange(options().grid_directions) * 2.0 * math.pi / options().grid_directions
        )
    starts = points if effect.begin == "score" else ()
    grid = points if effect.begin == "grid" else ()
    return [
        EffectInstance(effect, one, specs, starts, grid, contains=contained(effect, one, boat))
        for one in chosen
    ]


def contained(effect: Effect, thrusters: tuple[str, ...], boat: Boat) -> tuple[str, ...]:
    """Labels of the instances that an effect on these thrusters contains: of those that it declares, by the
    names that they have on this boat.
    """
    declared = [LIBRARY[name] for name in effect.contains]
    return tuple(
        " ".join((one.name, *thrusters)) if selectors(one, boat) else one.alone_equals for one in declared
    )


def spec_of(effect: Effect, parameter: Parameter, boat: Boat, reference: Reference) -> Spec:
    """The search of one parameter in its unit, within the library's bounds unless `values` sees to those."""
    search = parameter.search
    assert search is not None  # `declare` refuses an effect without
    unit = float(getattr(reference, search.of))
    scale, low, high = search.scale * unit, search.low * unit, search.high * unit
    if parameter.name not in (*(effect.vector or ()), *(effect.half_turn or ())):
        low = max(low, parameter.low + (1e-6 * scale if parameter.above_low else 0.0))
        high = min(high, parameter.high)
    starts = tuple(start * unit for start in search.starts)
    if not starts and parameter.neutral is None:
        own = neutral_of(parameter, boat)
        starts, low, high = (own,), min(low, own), max(high, own)
    difference = 1e-6 * scale if search.step is None else search.step * unit
    is_time = parameter.unit == "s" and search.step is not None
    if search.prior is None:
        return Spec(scale, low, high, starts, difference, is_time=is_time)
    prior, mean = prior_deviation(search.prior, boat), neutral_of(parameter, boat)
    return Spec(scale, low, high, starts, difference, prior, mean, is_time)


def prior_deviation(prior: float | tuple[str, ...], boat: Boat) -> float | None:
    """Standard deviation of a prior: σ² = σ₁² + x₁² Σ (σᵢ / xᵢ)² where numbers of the boat file make it; None
    where the file gives none of these a standard deviation.
    """
    if not isinstance(prior, tuple):
        return prior
    first, *others = (float(value_at(boat, key.split("."))) for key in prior)
    deviations = [given.sd if (given := boat.provenance.get(key)) else None for key in prior]
    own, *more = (float(one) if isinstance(one, float | int) else 0.0 for one in deviations)
    shares = [sd / value for sd, value in zip(more, others, strict=True) if value]
    return math.hypot(own, *(first * share for share in shares)) or None


def neutral_of(parameter: Parameter, boat: Boat) -> float:
    """The value that changes nothing: the boat file's own where the library has none."""
    if parameter.neutral is not None:
        return parameter.neutral
    return float(np.mean(parameters(boat)[parameter.field]))


def selectors(effect: Effect, boat: Boat) -> list[tuple[str, ...]]:
    """Thrusters that an effect may act on: none, each one, pairs; all together for a mounting error."""
    if effect.swaps:
        return list(itertools.combinations(boat.thruster_names, 2))
    if not effect.thruster:
        return [()]
    each: list[tuple[str, ...]] = [(t.name,) for t in boat.thrusters if able(t, effect.needs)]
    if len(each) < 2:
        return [] if effect.alone_equals else each
    return [*each, ("all",)] if effect.all_together else each


def hull_nuisance(boat: Boat) -> EffectInstance | None:
    """Scales of the hull's linear derivatives, with a Gaussian prior about 1; None without such an effect."""
    return next((one for one in nuisances(boat) if not one.effect.beside), None)


def nuisances(boat: Boat) -> list[EffectInstance]:
    """Effects on numbers that no boat file has exactly; those whose priors the boat file determines only
    where it gives all of them a standard deviation.
    """
    every = [one for effect in LIBRARY.values() if effect.nuisance for one in instances_of(effect, boat)]
    return [one for one in every if all(spec.prior for spec in one.specs)]


def by_label(instances: Sequence[EffectInstance]) -> Mapping[str, EffectInstance]:
    """Effect instances by label."""
    return {instance.label: instance for instance in instances}
