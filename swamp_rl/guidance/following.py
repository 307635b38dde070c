"""Waypoint and line following: line of sight outside, velocity inner loop and thrust allocation inside."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.guidance.drive import Drive, allocated
from swamp_rl.guidance.integral_line_of_sight import drift_corrected
from swamp_rl.guidance.line_of_sight import Waypoint, leg_after
from swamp_rl.guidance.loop import Seen
from swamp_rl.guidance.servo import VelocityServo

Array = NDArray[np.float64]

# Of a boat as long as SWAMP; others by Froude's law.
HEADING_GAIN = 0.5  # 1/s, yaw rate asked for per heading error, a third of the inner loop's speed
YAW_RATE_LIMIT = 0.4  # rad/s
RADIUS = 1.5  # m from a waypoint at which the next leg begins
LOOKAHEAD = 4.0  # m, three lengths of SWAMP
INTEGRAL = 0.3  # of the line of sight: a third of the way back to the line at once, the rest learnt


class PathFollower:
    """Follows the legs between waypoints at a set speed over ground [m/s], and stops thrusting at the last.

    It steers by azimuths, rudders and thrust alike: surge force and yaw moment are wanted, sway force is not.
    length [m]: of the boat, by which distances and times are scaled.
    """

    def __init__(
        self,
        drive: Drive,
        servo: VelocityServo,
        waypoints: Sequence[Waypoint],
        speed: float,
        length: float = SWAMP_LENGTH,
    ) -> None:
        self.drive = drive
        self.scale = length / SWAMP_LENGTH
        self.radius = RADIUS * self.scale
        self.servo = servo
        self.waypoints = waypoints
        self.speed = speed
        self.leg = 0
        self.drift = 0.0

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]."""
        place = Waypoint(seen.north, seen.east)
        leg = leg_after(place, self.waypoints, self.leg, self.radius)
        if leg != self.leg:
            self.leg, self.drift = leg, 0.0
        if self.leg >= len(self.waypoints) - 1:
            return np.concatenate([seen.azimuth, np.zeros(len(seen.azimuth))])
        start, end = self.waypoints[self.leg], self.waypoints[self.leg + 1]
        lookahead = LOOKAHEAD * self.scale
        heading, self.drift = drift_corrected(place, start, end, lookahead, INTEGRAL, self.drift, dt)
        return self.steer(heading, seen, dt)

    def steer(self, heading: float, seen: Seen, dt: float) -> Array:
        """Commands that bring the bow to `heading` [rad] and the speed to the set one."""
        turning = turning_to(heading, seen.heading, self.scale)
        return steered(self.drive, self.servo, self.speed, turning, seen, dt)


def turning_to(heading: float, now: float, scale: float, bend: float = 0.0) -> float:
    """Yaw rate [rad/s] that brings the bow from `now` to `heading` [rad], on a path that turns by `bend`.

    scale: the boat's length in those of SWAMP; within `YAW_RATE_LIMIT` by Froude's law.
    """
    rate = HEADING_GAIN * wrapped(heading - now) + bend * scale**0.5
    return float(np.clip(rate, -YAW_RATE_LIMIT, YAW_RATE_LIMIT)) / scale**0.5


def steered(drive: Drive, servo: VelocityServo, speed: float, turning: float, seen: Seen, dt: float) -> Array:
    """(2K,) commands for a surge speed [m/s] and a yaw rate [rad/s]; no sway force is asked for."""
    actual = seen.velocity
    wanted = np.array([speed, actual[1], turning])
    asked = servo.force(wanted, actual)
    asked[1] = 0.0
    found = allocated(drive, asked, seen, dt)
    servo.learn(wanted, actual, asked, found.achieved, dt)
    servo.memory[1] = 0.0
    return found.commands
