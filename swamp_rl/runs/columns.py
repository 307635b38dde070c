"""What each column of a run may hold: its unit and its range, for the boat that was driven."""

import math
import re
from dataclasses import dataclass

from swamp_rl.boat import Boat, PropellerRudder

REQUIRED = ("time", "north", "east", "heading")
_COMMAND = re.compile(r"(?P<applied>applied_)?(?P<kind>azimuth|throttle|rudder|propeller)_(?P<name>\w+)")


@dataclass(frozen=True)
class Span:
    """The values a column may take, from `low` to `high`; `above` excludes `low` itself."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    above: bool = False

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{'(' if self.above else '['}{self.low:.6g}, {self.high:.6g}]{unit}"


FARTHEST = 1e8
"""m: twice round the Earth, so that coordinates of any national grid lie within."""
FASTEST = 1e3
"""m/s: of no boat and no wind."""

FIXED = {
    "time": Span("s"),
    "north": Span("m", -FARTHEST, FARTHEST),
    "east": Span("m", -FARTHEST, FARTHEST),
    "heading": Span("rad", -math.pi, math.pi, above=True),
    "surge": Span("m/s", -FASTEST, FASTEST),
    "sway": Span("m/s", -FASTEST, FASTEST),
    "yaw_rate": Span("rad/s", -math.tau, math.tau),
    "joy_thrust": Span("1", 0.0, 1.0),
    "joy_angle": Span("1", -1.0, 1.0),
    "wind_speed": Span("m/s", 0.0, FASTEST),
    "wind_from": Span("rad", -math.tau, math.tau),
    "depth": Span("m", 0.0, above=True),
}


ENDLESS = Span("rad")  # of an azimuth that counts its turns
ONE_TURN = Span("rad", -math.tau, math.tau)
WIDEST = {  # of any boat's command
    "azimuth": ENDLESS,
    "throttle": Span("1", -1.0, 1.0),
    "rudder": Span("rad", -0.5 * math.pi, 0.5 * math.pi),
    "propeller": Span("rps"),
}


NO_THRUSTER = "has no thruster"
"Words by which an importer knows the fault, to name its options."


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
    if boat is None:
        return WIDEST[match["kind"]]
    return _thruster_span(match["kind"], match["name"], match["applied"] is not None, boat)


def is_angle(column: str) -> bool:
    """Whether a column of the format is in radians."""
    span = span_of(column, None)
    return span is not None and span.unit == "rad"


def _thruster_span(kind: str, name: str, applied: bool, boat: Boat) -> Span:
    named = [found for found in boat.thrusters if f"{kind}_{name}" in found.command_columns]
    if not named:
        raise UnknownThrusterError(
            f"boat {boat.name} {NO_THRUSTER} {name!r} whose command is {kind} "
            f"(its commands are {', '.join(command_columns(boat))}); "
            "correct the column's name, or name the boat that has it"
        )
    thruster = named[0]
    if kind in ("throttle", "propeller"):
        return Span(WIDEST[kind].unit, thruster.throttle_min, thruster.throttle_max)
    # What the actuator did may pass the limits of what may be commanded: a mounting error turns it further.
    if applied:
        return WIDEST[kind]
    if isinstance(thruster, PropellerRudder):
        return Span("rad", -thruster.rudder_max, thruster.rudder_max)
    if thruster.endless:
        return ENDLESS
    return Span("rad", thruster.azimuth_min, thruster.azimuth_max)


def command_columns(boat: Boat) -> list[str]:
    """The columns of the commands of a boat's thrusters."""
    return [name for thruster in boat.thrusters for name in thruster.command_columns if name is not None]


def command_limits(boat: Boat) -> dict[str, float]:
    """The greatest size of each command of a boat's thrusters, infinite where an azimuth has no limits."""
    spans = {name: span_of(name, boat) for name in command_columns(boat)}
    return {name: max(-span.low, span.high) for name, span in spans.items() if span is not None}


def missing_columns(columns: list[str], boat: Boat | None) -> list[str]:
    """Columns a run must have and does not: the required, and the rest of a half-recorded set of commands."""
    missing = [name for name in REQUIRED if name not in columns]
    commands = command_columns(boat) if boat is not None else []
    commanded = any(name in columns for name in commands)
    return missing + [name for name in commands if commanded and name not in columns]
