"""A level of disturbances made for one boat, for another: speeds, times, lengths and masses in proportion."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from swamp_rl.constants import (
    FASTEST_BOAT,
    HEAVIEST_BOAT,
    LIGHTEST_BOAT,
    LONGEST_BOAT,
    SHORTEST_BOAT,
    SLOWEST_BOAT,
)
from swamp_rl.effects.declare import LIBRARY
from swamp_rl.effects.entries import ALL, is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml

KEY = "boat"
POWERS = {"m": (1, 0, 0), "m/s": (0, 1, 0), "s": (1, -1, 0), "kg": (0, 0, 1)}
"""By unit, the powers of the ratios of length, top speed and mass that a number is multiplied by."""


class Size(NamedTuple):
    """What a level is proportioned by: length [m], top speed [m/s] and mass [kg] of a boat."""

    length: float
    speed: float
    mass: float


SMALLEST = Size(SHORTEST_BOAT, SLOWEST_BOAT, LIGHTEST_BOAT)
LARGEST = Size(LONGEST_BOAT, FASTEST_BOAT, HEAVIEST_BOAT)


def fitted_level(
    given: Mapping[str, Any], where: str, size: Size | None, thruster_names: Sequence[str]
) -> dict[str, Any]:
    """The content of a level's file for a boat of that size with those thrusters, without its key `boat`.

    As it stands where it names no boat, or one as long with all the thrusters that it names. Otherwise its
    lengths, speeds, times and masses are multiplied by the boats' ratios, and an effect on thrusters that the
    boat lacks is left out. UserError where `boat` is not {length, speed, mass}.
    """
    whole = {key: value for key, value in given.items() if key != KEY}
    if KEY not in given:
        return whole
    made_for = _size(given[KEY], where)
    entries = whole.get("effects", [])
    if size is None or not isinstance(entries, list):
        return whole
    known = [_with_known(entry, thruster_names) for entry in entries]
    if known == entries and size.length == made_for.length:
        return whole
    ratios = [own / other for own, other in zip(size, made_for, strict=True)]
    whole["effects"] = [_in_proportion(entry, ratios) for entry in known if entry is not None]
    start = whole.get("start")
    if isinstance(start, Mapping):
        units = {"north": "m", "east": "m"}
        whole["start"] = {key: _times(value, _factor(units.get(key), ratios)) for key, value in start.items()}
    return whole


def _size(given: Any, where: str) -> Size:
    keys = Size._fields
    good = isinstance(given, Mapping) and set(given) == set(keys) and all(map(is_number, given.values()))
    if not good:
        raise UserError(f"{where}: {KEY} must be {{length: m, speed: m/s, mass: kg}}, each above 0")
    found = Size(*(float(given[key]) for key in keys))
    for key, value, low, high in zip(keys, found, SMALLEST, LARGEST, strict=True):
        if not low <= value <= high:
            raise UserError(f"{where}: {KEY}.{key} must be {low:g} to {high:g}, not {in_yaml(given[key])}")
    return found


def _with_known(entry: Any, names: Sequence[str]) -> Any:
    """The entry with those thrusters alone that the boat has; None where it has none of them."""
    if not isinstance(entry, Mapping) or entry.get("thruster") in (None, ALL):
        return entry
    thruster = entry["thruster"]
    choice = thruster.get("choice") if isinstance(thruster, Mapping) else None
    if isinstance(choice, list):
        kept = [name for name in choice if name in names]
        return {**entry, "thruster": {"choice": kept}} if kept else None
    named = thruster if isinstance(thruster, list) else [thruster]
    return entry if all(name in names for name in named) else None


def _in_proportion(entry: Any, ratios: Sequence[float]) -> Any:
    """An entry with its numbers multiplied; what is malformed stays, to be refused by its reader."""
    effect = LIBRARY.get(str(entry.get("effect"))) if isinstance(entry, Mapping) else None
    if effect is None:
        return entry
    units = {parameter.name: parameter.unit for parameter in effect.parameters}
    units["disc"] = units.get("north", "1")
    units["components"] = units[effect.vector[0]] if effect.vector else "1"
    return {key: _times(value, _factor(units.get(key), ratios)) for key, value in entry.items()}


def _factor(unit: str | None, ratios: Sequence[float]) -> float:
    factor = 1.0
    for ratio, power in zip(ratios, POWERS.get(str(unit), (0, 0, 0)), strict=True):
        factor *= ratio**power
    return factor


def _times(value: Any, factor: float) -> Any:
    """A number, or every number of a distribution, times the factor."""
    if isinstance(value, Mapping):
        return {key: _times(inner, factor) for key, inner in value.items()}
    if isinstance(value, list):
        return [_times(inner, factor) for inner in value]
    return value * factor if is_number(value) else value
