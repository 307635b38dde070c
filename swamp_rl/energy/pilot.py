"""The controller of a mission: leg after leg by line of sight, commands held while nothing changes."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.energy.mission import Leg, Mission
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.following import PathFollower
from swamp_rl.guidance.line_of_sight import Waypoint, leg_after, offset
from swamp_rl.guidance.loop import Seen
from swamp_rl.guidance.servo import servo_of

Array = NDArray[np.float64]

AHEAD = 2.0  # of the way that a leg with a duration asks for: its line does not end before it
STILL, CALM = 5e-4, 4  # change of command and of velocity a tick, for so many ticks, that counts as steady
DRIFT, TURNED, ASIDE = 2e-3, 0.02, 0.1  # m/s and rad/s, rad, m: beyond these it is controlled anew


class MissionPilot:
    """Flies the legs of a mission; `leg` is the one under way, `None` after the last.

    begun, expected: time [s] at which it began, and that it takes at its speed.

    Once commands and velocity are steady at the speed of the leg, the commands are held until the boat
    departs from that state by `DRIFT`, `TURNED` or `ASIDE`, or the leg ends: until then the allocation need
    not be solved again.
    """

    def __init__(self, boat: Boat, mission: Mission) -> None:
        self.drive, self.length = drive_of(boat), boat.length
        self.servo = servo_of(boat)
        self.legs: Sequence[Leg] = mission.legs
        self.course = mission.course
        self.leg: int | None = -1
        self.begun = 0.0
        self.held: Array | None = None

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]; the throttles are 0 after the last leg."""
        while self.leg is not None and (self.leg < 0 or self._over(seen, dt)):
            self._next(seen)
        if self.leg is None:
            return np.concatenate([seen.azimuth, np.zeros(len(seen.azimuth))])
        if self.held is None or self._departed(seen):
            self._steer(seen, dt)
        return self.commands

    def _over(self, seen: Seen, dt: float) -> bool:
        """Whether the leg under way has ended."""
        assert self.leg is not None
        duration = self.legs[self.leg].duration_s
        if duration is not None:
            return seen.time - self.begun > duration - 0.5 * dt
        way = self.follower.waypoints
        place = Waypoint(seen.north, seen.east)
        return leg_after(place, way, self.follower.leg, self.follower.radius) >= len(way) - 1

    def _next(self, seen: Seen) -> None:
        """Begin the next leg from where the boat is."""
        assert self.leg is not None
        self.leg += 1
        if self.leg >= len(self.legs):
            self.leg = None
            return
        leg, here = self.legs[self.leg], Waypoint(seen.north, seen.east)
        if leg.waypoints is not None:
            way = [here, *(Waypoint(*place) for place in leg.waypoints)]
            self.course = math.atan2(way[-1].east - way[-2].east, way[-1].north - way[-2].north)
        else:
            if leg.course_deg is not None:
                self.course = math.radians(leg.course_deg)
            far = AHEAD * leg.speed * (leg.duration_s or 0.0) + 1.0
            north, east = far * math.cos(self.course), far * math.sin(self.course)
            way = [here, Waypoint(here.north + north, here.east + east)]
        self.follower = PathFollower(self.drive, self.servo, way, leg.speed, self.length)
        length = sum(math.dist(a, b) for a, b in pairwise(way))
        self.expected = length / leg.speed if leg.duration_s is None else leg.duration_s
        self.begun, self.held, self.calm = seen.time, None, 0
        self.commands = np.full(2 * len(seen.azimuth), np.inf)
        self.before = seen

    def _steer(self, seen: Seen, dt: float) -> None:
        """Decide anew, and hold the decision once it has been steady for `CALM` ticks."""
        commands = self.follower.act(seen, dt)
        change = max(
            float(np.abs(commands - self.commands).max()),
            float(np.abs(seen.velocity - self.before.velocity).max()),
        )
        on_speed = abs(seen.surge - self.follower.speed) < 0.5 * DRIFT
        self.calm = self.calm + 1 if change < STILL and on_speed else 0
        self.commands, self.before = commands, seen
        self.held = commands if self.calm >= CALM else None

    def _departed(self, seen: Seen) -> bool:
        """Whether the boat has left the steady state, or passed a waypoint, since the commands were held."""
        then, follower = self.before, self.follower
        if float(np.abs(seen.velocity - then.velocity).max()) > DRIFT:
            return True
        if abs(wrapped(seen.heading - then.heading)) > TURNED:
            return True
        place, line = Waypoint(seen.north, seen.east), follower.waypoints[follower.leg : follower.leg + 2]
        aside = offset(place, *line).across - offset(Waypoint(then.north, then.east), *line).across
        return (
            abs(aside) > ASIDE
            or leg_after(place, follower.waypoints, follower.leg, follower.radius) != follower.leg
        )
