"""One effect of a disturbance level, with distributions in place of numbers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.effects.apply import selected
from swamp_rl.effects.curve import Curve
from swamp_rl.effects.declare import LIBRARY, Effect, Parameter
from swamp_rl.effects.distributions import (
    Array,
    Distribution,
    columns,
    each,
    option,
    parse_distribution,
)
from swamp_rl.effects.entries import (
    EffectEntry,
    Selector,
    complete,
    curve_entry,
    effect_and_keys,
    entry_mapping,
    is_number,
    parameter_number,
    parse_selector,
)
from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml

DISC = ("north", "east")
COMPONENTS = "components"


@dataclass(frozen=True)
class Drawn:
    """An entry drawn for n episodes.

    on: (n,) whether it is there. which: (n,) index into `selectors` of the thruster meant. values: by
    parameter (n,).
    """

    effect: Effect
    on: NDArray[np.bool_]
    which: NDArray[np.intp]
    selectors: tuple[Selector, ...]
    values: dict[str, Array]
    curve: Curve | None = None

    def thrusters(self, thruster_names: Sequence[str]) -> NDArray[np.bool_]:
        """(n, K) which thrusters are meant."""
        return np.array([selected(name, thruster_names) for name in self.selectors])[self.which]

    def mapping(self, episode: int) -> dict[str, Any] | None:
        """The effect with its numbers as it stands in YAML; None where it is not there."""
        if not self.on[episode]:
            return None
        thruster = self.selectors[self.which[episode]]
        values = {name: float(values[episode]) for name, values in self.values.items()}
        return entry_mapping(EffectEntry(self.effect, thruster, values, self.curve))


@dataclass(frozen=True)
class RandomEntry:
    """An effect to be drawn.

    selectors: the equally likely thrusters (or `all`), (None,) where the effect has no selector. disc: radius
    within which north and east [their unit] are drawn, direction and length uniform; None where they have
    distributions of their own. probability: of the effect being there at all. by_components: whether `values`
    holds the north and east component of the effect's vector in place of its size and direction. curve: with
    numbers alone.
    """

    effect: Effect
    selectors: tuple[Selector, ...]
    values: Mapping[str, Distribution]
    disc: float | None
    probability: float
    by_components: bool = False
    curve: Curve | None = None

    @property
    def _widths(self) -> list[int]:
        own = [int(self.probability < 1.0), int(len(self.selectors) > 1), 0 if self.disc is None else 2]
        return own + [value.draws for value in self.values.values()]

    @property
    def draws(self) -> int:
        """How many uniforms an episode takes, whether or not the effect turns out to be there."""
        return sum(self._widths)

    def column(self, parameter: str) -> int:
        """Which of its uniforms a parameter with a distribution is drawn from."""
        place = list(self.values).index(parameter)
        return sum(self._widths[: len(self._widths) - len(self.values) + place])

    def draw(self, uniforms: Array) -> Drawn:
        """The effect for n episodes from uniforms (n, draws)."""
        chance, choice, disc, *rest = columns(uniforms, self._widths)
        on = np.all(chance < self.probability, axis=1)
        which = np.zeros(len(uniforms), dtype=np.intp)
        if choice.shape[1]:
            which = option(choice[:, 0], len(self.selectors))
        values = {
            name: value.values(block) for (name, value), block in zip(self.values.items(), rest, strict=True)
        }
        if self.disc is not None:
            direction, length = 2.0 * math.pi * disc[:, 0], self.disc * disc[:, 1]
            values["north"] = length * each(math.cos, direction)
            values["east"] = length * each(math.sin, direction)
        if self.by_components and self.effect.vector:
            north, east = (values.pop(name) for name in DISC)
            size, direction_name = self.effect.vector
            pairs = list(zip(north.tolist(), east.tolist(), strict=True))
            values[size] = np.array([math.hypot(*pair) for pair in pairs])
            values[direction_name] = np.array([math.atan2(y, x) for x, y in pairs])
        return Drawn(self.effect, on, which, self.selectors, values, self.curve)


def parse_random_entry(entry: Any, where: str, thruster_names: Sequence[str]) -> RandomEntry:
    """An entry of a disturbance level; `where` begins every message. UserError."""
    has_disc = isinstance(entry, Mapping) and _takes_disc(entry.get("effect"))
    own = [*(["disc"] if has_disc else []), *([COMPONENTS] if _has_vector(entry) else [])]
    effect, given = effect_and_keys(entry, where, ("probability", *own))
    where = f"{where} {effect.name}"
    probability = _probability(given.pop("probability", 1.0), where)
    selectors: tuple[Selector, ...] = (None,)
    if effect.curve:
        fixed = curve_entry(effect, given, where, thruster_names)
        numbers = {name: Distribution("number", (value,)) for name, value in fixed.values.items()}
        return RandomEntry(effect, (fixed.thruster,), numbers, None, probability, curve=fixed.curve)
    if effect.selects:
        selectors = _selectors(effect, given.pop("thruster", None), where, thruster_names)
    disc = _disc(effect, given, where) if "disc" in given else None
    parts = _components(effect, given, where) if COMPONENTS in given else {}
    values = {name: _bounded(effect.parameter(name), value, where) for name, value in given.items()}
    if disc is None:
        values |= dict.fromkeys(effect.vector or (), Distribution("number", (0.0,))) if parts else {}
        values = complete(effect, values, where, lambda number: Distribution("number", (number,)))
    if parts:
        values = parts | {name: one for name, one in values.items() if name not in (effect.vector or ())}
    return RandomEntry(effect, selectors, values, disc, probability, bool(parts))


def _takes_disc(name: Any) -> bool:
    return isinstance(name, str) and name in LIBRARY and set(DISC) <= set(LIBRARY[name].parameter_names)


def _has_vector(entry: Any) -> bool:
    named = entry.get("effect") if isinstance(entry, Mapping) else None
    return isinstance(named, str) and named in LIBRARY and LIBRARY[named].vector is not None


def _components(effect: Effect, given: dict[str, Any], where: str) -> dict[str, Distribution]:
    """The distributions of the north and east component of an effect's vector."""
    size, direction = effect.vector or ("", "")
    parts = given.pop(COMPONENTS)
    for name in (size, direction):
        if name in given:
            raise UserError(f"{where}: {COMPONENTS} draws {size} and {direction}; remove {name}")
    if not isinstance(parts, Mapping) or set(parts) != set(DISC):
        raise UserError(
            f"{where}: {COMPONENTS} must be {{north: ..., east: ...}}, each drawn, not {in_yaml(parts)}"
        )
    whole = effect.parameter(size)
    drawn = {
        name: parse_distribution(parts[name], f"{where}: {COMPONENTS}.{name} [{whole.unit}]") for name in DISC
    }
    parameter_number(whole, math.hypot(*(max(map(abs, one.reach)) for one in drawn.values())), where)
    return drawn


def _probability(given: Any, where: str) -> float:
    if not is_number(given) or not 0.0 < given <= 1.0:
        raise UserError(f"{where}: probability must be above 0 and at most 1, not {in_yaml(given)}")
    return float(given)


def _selectors(effect: Effect, given: Any, where: str, thruster_names: Sequence[str]) -> tuple[Selector, ...]:
    names = [given]
    if isinstance(given, Mapping):
        names = given.get("choice", [])
        if len(given) != 1 or not isinstance(names, list) or not names:
            raise UserError(
                f"{where}: thruster must be a name, all, or {{choice: [names]}}, not {in_yaml(given)}"
            )
    return tuple(parse_selector(effect, name, where, thruster_names) for name in names)


def _disc(effect: Effect, given: dict[str, Any], where: str) -> float:
    radius = given.pop("disc")
    if given:
        raise UserError(f"{where}: disc draws {' and '.join(DISC)}; remove {', '.join(given)}")
    if not is_number(radius) or radius < 0.0:
        unit = effect.parameter(DISC[0]).unit
        raise UserError(f"{where}: disc must be a radius [{unit}] of at least 0, not {in_yaml(radius)}")
    return parameter_number(effect.parameter(DISC[0]), radius, f"{where}: disc")


def _bounded(parameter: Parameter, given: Any, where: str) -> Distribution:
    distribution = parse_distribution(given, f"{where}: {parameter.name} [{parameter.unit}]")
    for number in distribution.reach:
        parameter_number(parameter, number, where)
    return distribution
