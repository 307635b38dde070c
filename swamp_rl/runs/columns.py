"""What each column of a run may hold: its unit and its range, for the boat that was driven."""

import math
import re
from dataclasses import dataclass

from swamp_rl.boat import Boat

REQUIRED = ("time", "north", "east", "heading")
_TURN = 2.0 * math.pi
_COMMAND = re.compile(r"(?P<applied>applied_)?(?P<kind>azimuth|throttle|rudder|propeller)_(?P<name>\w+)")


@dataclass(frozen=True)
class Span:
    """The values a column may take, from `low` to `high`; `above` excludes `low` itself."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    above: bool = False

    def __str__(self) -> str:
        return f"{'(' if self.above else '['}{self.low:.6g}, {self.high:.6g}] {self.unit}"


FIXED = {
    "time": Span("s"),
    "north": Span("m"),
    "east": Span("m"),
    "heading": Span("rad", -math.pi, math.pi, above=True),
    "surge": Span("m/s"),
    "sway": Span("m/s"),
    "yaw_rate": Span("rad/s", -_TURN, _TURN),
    "joy_thrust": Span("1", 0.0, 1.0),
    "joy_angle": Span("1", -1.0, 1.0),
    "wind_speed": Span("m/s", 0.0),
    "wind_from": Span("rad", -_TURN, _TURN),
    "depth": Span("m", 0.0, above=True),
}


class UnknownThrusterError(ValueError):
    """A command column names a thruster that the boat does not have."""


def span_of(column: str, boat: Boat | None) -> Span | None:
    """The span of a column, or None for a column the format does not know.

    Without a boat any thruster name is taken, with the widest limits a boat may have.
    """
    if column in FIXED:
        return FIXED[column]
    match = _COMMAND.fullmatch(column)
    if match is None:
        return None
    if match["kind"] == "rudder":
        return Span("rad", -math.pi, math.pi)
    if match["kind"] == "propeller":
        return Span("rps")
    if boat is None:
        return Span("rad", -_TURN, _TURN) if match["kind"] == "azimuth" else Span("1", -1.0, 1.0)
    return _thruster_span(match["kind"], match["name"], match["applied"] is not None, boat)


def _thruster_span(kind: str, name: str, applied: bool, boat: Boat) -> Span:
    named = [thruster for thruster in boat.thrusters if thruster.name == name]
    if not named or (kind == "azimuth" and named[0].kind != "azimuth"):
        raise UnknownThrusterError(
            f"boat {boat.name} has no {'azimuth ' if kind == 'azimuth' else ''}thruster {name!r} "
            f"(it has {', '.join(boat.thruster_names)}); correct the column, or vehicle in dataset.yaml"
        )
    if kind == "throttle":
        return Span("1", -1.0 if named[0].reverses else 0.0, 1.0)
    # What the actuator did may pass the limits of what may be commanded: a mounting error turns it further.
    return Span("rad", -_TURN, _TURN) if applied else Span("rad", named[0].azimuth_min, named[0].azimuth_max)


def missing_columns(columns: list[str], boat: Boat | None) -> list[str]:
    """Columns a run must have and does not: the required, and the rest of a half-recorded set of commands."""
    missing = [name for name in REQUIRED if name not in columns]
    if boat is None:
        return missing
    azimuths = [f"azimuth_{found.name}" for found in boat.thrusters if found.kind == "azimuth"]
    commands = azimuths + [f"throttle_{name}" for name in boat.thruster_names]
    commanded = any(name in columns for name in commands)
    return missing + [name for name in commands if commanded and name not in columns]
