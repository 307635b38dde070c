"""Station keeping with two jets or more: a position loop outside the velocity loop (thesis 6.4, 6.5)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, Wish, allocate
from swamp_rl.angles import turned, wrapped
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.guidance.drive import MOMENT
from swamp_rl.guidance.loop import Seen
from swamp_rl.guidance.servo import VelocityServo

Array = NDArray[np.float64]

# Of a boat as long as SWAMP; others by Froude's law.
POSITION_GAIN, HEADING_GAIN = 0.25, 0.4  # 1/s, a third of the inner loop's bandwidth
SPEED_LIMIT, TURN_LIMIT = 0.3, 0.3  # m/s, rad/s at which the boat returns at most
WISH = Wish(change=0.05, moment=MOMENT)  # a boat turned away from its heading cannot hold what it could


class Station(NamedTuple):
    """Where to stay [m] and where the bow shall point [rad]."""

    north: float
    east: float
    heading: float


class StationKeeper:
    """Brings the boat back to its station and holds it there against steady pushes, which it learns.

    length [m]: of the boat, by which speeds and times are scaled.
    """

    def __init__(
        self,
        jets: Jets,
        servo: VelocityServo,
        station: Station,
        length: float = SWAMP_LENGTH,
    ) -> None:
        self.jets = jets
        self.servo = servo
        self.station = station
        self.pace = (length / SWAMP_LENGTH) ** 0.5
        self.before = np.zeros((len(jets.names), 2))

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]."""
        wanted, actual = self.velocity_wanted(seen), seen.velocity
        asked = self.servo.force(wanted, actual)
        found = allocate(self.jets, asked, seen.azimuth, dt, WISH, self.before)
        self.servo.learn(wanted, actual, asked, found.achieved, dt)
        self.before = found.forces
        return found.commands

    def velocity_wanted(self, seen: Seen) -> Array:
        """(3,) surge, sway [m/s over ground], yaw rate [rad/s] back to the station, never too fast."""
        north = POSITION_GAIN / self.pace * (self.station.north - seen.north)
        east = POSITION_GAIN / self.pace * (self.station.east - seen.east)
        slower = min(1.0, SPEED_LIMIT * self.pace / max(math.hypot(north, east), 1e-9))
        ahead, starboard = turned(north, east, -seen.heading)
        turning = HEADING_GAIN / self.pace * wrapped(self.station.heading - seen.heading)
        limit = TURN_LIMIT / self.pace
        return np.array(
            [
                slower * ahead,
                slower * starboard,
                min(max(turning, -limit), limit),
            ]
        )
