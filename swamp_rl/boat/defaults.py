"""What a boat file may leave out of `wind`, `current` and `joypad`: defaults from its dimensions."""

import math
from collections.abc import Mapping
from typing import Any

from swamp_rl.boat.merge import value_of
from swamp_rl.boat.quantity import SPREAD
from swamp_rl.effects.entries import is_number

HEIGHT = 0.2  # of the profile above water, over the length
FILLED = 0.75  # share of length times height that the lateral profile fills
LEVER = math.radians(60.0)  # azimuth at the lever's ends, where the thrusters turn so far
SHARES = "ours, shares of length, breadth and draught"
DNV = "DNV-GL, as in configs/boats/swamp.yaml"
RELATIVE = "of no use with the model `relative`"


def assumed(value: Any, unit: str, source: str, sd: Any = None) -> dict[str, Any]:
    """A number of a boat file that was not measured; sd: standard deviation of its prior, in its unit."""
    spread = {} if sd is None else {SPREAD: sd}
    return {"value": value, "unit": unit, "provenance": "assumed", "source": source, **spread}


def defaults_of(raw: Mapping[str, Any]) -> dict[str, Any]:
    """What the merged file leaves out of its sections `wind`, `current` and `joypad`, by section and key.

    Nothing where `raw` lacks what they follow from: the schema then refuses the file.
    """
    found: dict[str, Any] = {}
    sizes = [_number(raw.get(name)) for name in ("length", "breadth", "draught")]
    if all(size > 0.0 for size in sizes):
        found |= {"wind": default_wind(*sizes[:2]), "current": default_current(*sizes)}
    thrusters = raw.get("thrusters")
    if isinstance(thrusters, list) and all(isinstance(item, Mapping) for item in thrusters):
        given = raw.get("joypad")
        chosen = given.get("thrusters") if isinstance(given, Mapping) else None
        found["joypad"] = default_joypad(thrusters, chosen)
    return {name: left for name, section in found.items() if (left := _left_out(section, raw.get(name)))}


def default_wind(length: float, breadth: float) -> dict[str, Any]:
    """The section `wind` of a boat of that length and breadth [m]: A_F = 0.2 L B, A_L = 0.15 L²."""
    frontal, lateral = HEIGHT * length * breadth, FILLED * HEIGHT * length**2
    return {
        "air_density": assumed(1.225, "kg/m3", "ISO 2533, at 15 deg C and sea level", 0.05),
        "frontal_area": assumed(frontal, "m2", SHARES, 0.5 * frontal),
        "lateral_area": assumed(lateral, "m2", SHARES, 0.5 * lateral),
        "lateral_centre": assumed(0.0, "m", "ours, amidships", 0.1 * length),
        "c_x": assumed(0.7, "1", DNV, 0.2),
        "c_y": assumed(0.9, "1", DNV, 0.2),
        "c_n": assumed(0.3, "1", DNV, 0.15),
    }


def default_current(length: float, breadth: float, draught: float) -> dict[str, Any]:
    """The section `current` of a boat of those dimensions [m]: the current acts by the relative velocity."""
    return {
        "model": "relative",
        "frontal_area": assumed(breadth * draught, "m2", RELATIVE),
        "lateral_area": assumed(length * draught, "m2", RELATIVE),
        "lateral_centre": assumed(0.0, "m", RELATIVE),
        "c_x": assumed(0.18, "1", RELATIVE),
        "c_y": assumed(0.6, "1", RELATIVE),
    }


def default_joypad(thrusters: list[Any], chosen: Any = None) -> dict[str, Any]:
    """The section `joypad` that drives these sections of `thrusters`, or those of the names `chosen`.

    Throttle from nothing to full; azimuth 60 degrees to either side, or as far as all of them turn.
    """
    names = [item.get("name") for item in thrusters] if chosen is None else chosen
    found = {"thrusters": names, "throttle": assumed([0.0, 1.0], "1", "ours, nothing to full")}
    driven = [item for item in thrusters if isinstance(names, list) and item.get("name") in names]
    turning = [item for item in driven if item.get("kind") != "fixed"]
    if turning:
        reach = min(LEVER, *(_reach(item) for item in turning))
        found["azimuth"] = assumed([-reach, reach], "rad", "ours, as far as they turn, 60 deg at most")
    return found


def _reach(thruster: Mapping[str, Any]) -> float:
    """How far [rad] a thruster turns to both sides."""
    given = [
        -_number(thruster.get("azimuth_min")),
        *map(_number, map(thruster.get, ("azimuth_max", "rudder_max"))),
    ]
    return min((side for side in given if side > 0.0), default=LEVER)


def _left_out(section: Mapping[str, Any], given: Any) -> dict[str, Any]:
    """The keys of a default section that the file's own does not have; none where that is no section."""
    if given is None:
        return dict(section)
    return {key: value for key, value in section.items() if isinstance(given, Mapping) and key not in given}


def _number(given: Any) -> float:
    """The number of a leaf, 0 where it is none that is finite."""
    value = value_of(given)
    return float(value) if is_number(value) else 0.0
