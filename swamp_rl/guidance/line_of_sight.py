"""Line-of-sight guidance along straight lines and from waypoint to waypoint (Fossen 2011, 10.3.2)."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from swamp_rl.angles import turned


class Waypoint(NamedTuple):
    """A place [m]."""

    north: float
    east: float


class Offset(NamedTuple):
    """Where a boat is against a line: `along` from its start, `across` to starboard of it [m]."""

    along: float
    across: float


def bearing(start: Waypoint, end: Waypoint) -> float:
    """Direction [rad] from one place to another, clockwise from north."""
    return math.atan2(end.east - start.east, end.north - start.north)


def offset(place: Waypoint, start: Waypoint, end: Waypoint) -> Offset:
    """A place seen from the line between two others (10.58)."""
    north, east = place.north - start.north, place.east - start.east
    return Offset(*turned(north, east, -bearing(start, end)))


def line_of_sight(place: Waypoint, start: Waypoint, end: Waypoint, lookahead: float) -> float:
    """Course [rad] that leads onto the line from `start` to `end`: at a point `lookahead` [m] on (10.72)."""
    return bearing(start, end) - math.atan(offset(place, start, end).across / lookahead)


def leg_after(place: Waypoint, waypoints: Sequence[Waypoint], leg: int, radius: float) -> int:
    """The leg to follow from here: the next once the end of `leg` is within `radius` [m], or passed.

    Leg i leads from waypoint i to i + 1. The answer is the number of legs once the last waypoint is reached;
    that one must be passed, the radius does not serve there.
    """
    last = len(waypoints) - 1
    while leg < last:
        start, end = waypoints[leg], waypoints[leg + 1]
        passed = offset(place, start, end).along >= math.dist(start, end)
        near = leg + 1 < last and math.dist(place, end) <= radius
        if not (passed or near):
            break
        leg += 1
    return leg
