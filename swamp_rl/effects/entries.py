"""Reading a list of effects: `[{effect: current, north: 0.1}, ...]` with every fault named."""

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.effects.curve import KEYS, Curve, parse_curve
from swamp_rl.effects.declare import LIBRARY, Effect, Parameter
from swamp_rl.errors import UserError
from swamp_rl.explain import alike, in_yaml, likest

ALL = "all"
LISTED = "`swamp-rl effects` lists all"
Selector = str | tuple[str, str] | None
Value = TypeVar("Value")


@dataclass(frozen=True)
class EffectEntry:
    """An effect with its numbers. thruster: a name, `all`, two names where it swaps two, or None.

    values: parameter name -> number [its unit]; a parameter left out takes its neutral value. curve: of an
    effect that has one; its values are by `Curve.value_names`.
    """

    effect: Effect
    thruster: Selector
    values: Mapping[str, float] = field(hash=False)
    curve: Curve | None = None

    @property
    def label(self) -> str:
        """Effect and thrusters."""
        thrusters = [self.thruster] if isinstance(self.thruster, str) else list(self.thruster or ())
        return " ".join([self.effect.name, *thrusters])

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """Of an entry as it stands in a file."""
        return {"type": "object", "properties": {"effect": {"enum": list(LIBRARY)}}}


def entry_mapping(entry: EffectEntry) -> dict[str, Any]:
    """An effect as it stands in a file."""
    selector = list(entry.thruster) if isinstance(entry.thruster, tuple) else entry.thruster
    thruster = {} if selector is None else {"thruster": selector}
    if entry.curve:
        return {"effect": entry.effect.name, **thruster, **entry.curve.mapping(entry.values)}
    return {"effect": entry.effect.name, **thruster, **{k: float(v) for k, v in entry.values.items()}}


def parse_effects(entries: Any, where: str, thruster_names: Sequence[str]) -> tuple[EffectEntry, ...]:
    """Effects with numbers, as they stand in a boat file; `where` begins every message. UserError."""
    return tuple(
        _entry(entry, f"{where}: effects[{index}]", thruster_names)
        for index, entry in enumerate(entry_list(entries, where))
    )


def entry_list(entries: Any, where: str) -> list[Any]:
    """`entries` if it is a list; UserError otherwise."""
    if not isinstance(entries, list | tuple):
        raise UserError(f"{where}: effects must be a list such as [{{effect: current, north: 0.1}}]")
    return list(entries)


def _entry(entry: Any, where: str, thruster_names: Sequence[str]) -> EffectEntry:
    effect, given = effect_and_keys(entry, where)
    where = f"{where} {effect.name}"
    if effect.curve:
        return curve_entry(effect, given, where, thruster_names)
    thruster = None
    if effect.selects:
        thruster = parse_selector(effect, given.pop("thruster", None), where, thruster_names)
    numbers = {name: parameter_number(effect.parameter(name), value, where) for name, value in given.items()}
    return EffectEntry(effect, thruster, complete(effect, numbers, where, float))


def curve_entry(
    effect: Effect, given: Mapping[str, Any], where: str, thruster_names: Sequence[str]
) -> EffectEntry:
    """The entry of an effect that holds a curve; UserError names the first fault."""
    curve, values = parse_curve(given, where)
    thruster = given.get("thruster")
    if curve.needs_thruster:
        check_thruster(thruster, where, thruster_names)
    if (thruster == ALL) or (thruster is not None and not curve.needs_thruster):
        raise UserError(f"{where}: thruster must be one of them, and only of a thrust, azimuth or throttle")
    return EffectEntry(effect, thruster, values, curve)


def effect_and_keys(entry: Any, where: str, also: Collection[str] = ()) -> tuple[Effect, dict[str, Any]]:
    """The effect that an entry names, and its other keys once they are known to belong to it or to `also`."""
    if not isinstance(entry, Mapping) or "effect" not in entry:
        raise UserError(f"{where}: must be a mapping with the key effect; {LISTED}")
    name = entry["effect"]
    if not isinstance(name, str) or name not in LIBRARY:
        raise UserError(f"{where}: unknown effect {in_yaml(name)}{nearest_effect(name)}")
    effect = LIBRARY[name]
    own = ["thruster", *KEYS] if effect.curve else ["thruster"] if effect.selects else []
    known = [*effect.parameter_names, *own, *also]
    given = {key: value for key, value in entry.items() if key != "effect"}
    for key in given:
        if key not in known:
            raise UserError(f"{where} {name}: unknown key {key!r}; {suggestion(key, known)}")
    return effect, given


def nearest_effect(name: Any) -> str:
    """The end of a complaint about an unknown effect: those most like it, and where all are listed."""
    near = " or ".join(map(repr, alike(clipped(str(name)), LIBRARY)))
    return f"; did you mean {near}? {LISTED}" if near else f"; {LISTED}"


def suggestion(name: Any, known: Collection[str]) -> str:
    """The nearest known name, if one is near, and all of them."""
    near = likest(str(name), known)
    return (f"did you mean {near!r}? " if near else "") + f"known here: {', '.join(known)}"


def parse_selector(effect: Effect, given: Any, where: str, thruster_names: Sequence[str]) -> Selector:
    """`given` as what the effect's key `thruster` may be; UserError otherwise."""
    if not effect.swaps:
        check_thruster(given, where, thruster_names)
        return str(given)
    if not isinstance(given, list | tuple) or len(given) != 2 or given[0] == given[1] or ALL in given:
        raise UserError(f"{where}: thruster must be two of them such as [{', '.join(thruster_names[:2])}]")
    for name in given:
        check_thruster(name, where, thruster_names)
    return str(given[0]), str(given[1])


def check_thruster(name: Any, where: str, thruster_names: Sequence[str]) -> None:
    """UserError unless `name` is a thruster of the boat or `all`."""
    if name is None:
        raise UserError(f"{where}: thruster is missing; add one of {', '.join((*thruster_names, ALL))}")
    if name not in (*thruster_names, ALL):
        raise UserError(
            f"{where}: unknown thruster {in_yaml(name)}; {suggestion(name, (*thruster_names, ALL))}"
        )


def parameter_number(parameter: Parameter, value: Any, where: str) -> float:
    """`value` as a number that the parameter allows; UserError otherwise."""
    if not is_number(value):
        raise UserError(
            f"{where}: {parameter.name} must be a number [{parameter.unit}], not {in_yaml(value)}"
        )
    if not parameter.allows(float(value)):
        raise UserError(
            f"{where}: {parameter.name} {value:.6g} is out of range; allowed: {parameter.allowed}"
        )
    return float(value)


def is_number(value: Any) -> bool:
    """Whether `value` is a finite number, be it of NumPy (and no truth value)."""
    value = value.item() if isinstance(value, np.number) else value
    # an integer too large for a float is no number here either, and isfinite() would raise on it
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def complete(
    effect: Effect, given: Mapping[str, Value], where: str, neutral: Callable[[float], Value]
) -> dict[str, Value]:
    """`given` in the order of declaration, with the neutral value where one was left out.

    UserError if nothing is given, or if one that must be given is not.
    """
    if effect.parameters and not given:
        raise UserError(f"{where}: gives no number; add {', '.join(effect.parameter_names)}")
    values = {}
    for parameter in effect.parameters:
        if parameter.name in given:
            values[parameter.name] = given[parameter.name]
        elif parameter.required or parameter.neutral is None:
            raise UserError(f"{where}: {parameter.name} [{parameter.unit}] is missing; add it")
        else:
            values[parameter.name] = neutral(parameter.neutral)
    return values
