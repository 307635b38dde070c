"""Following a curve, and following a vehicle along the way that it has taken (thesis 6.4)."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.guidance.curve import Curve
from swamp_rl.guidance.drive import Drive
from swamp_rl.guidance.following import LOOKAHEAD, YAW_RATE_LIMIT, steered, turning_to
from swamp_rl.guidance.heading import slowest_speed
from swamp_rl.guidance.loop import Seen
from swamp_rl.guidance.servo import VelocityServo

Array = NDArray[np.float64]

# Of a boat as long as SWAMP; others by Froude's law.
LEAD = 1.0  # s by which the curve's own yaw rate is read ahead: the lag of the yaw loop and of the boat
DRIFT_TIME = 0.5  # s over which the drift angle is averaged
CATCHING = 0.2  # 1/s, speed over the leader's per metre of the gap
SHARE = 0.8  # of the greatest yaw rate that a bend may ask for


class Pace(Protocol):
    """How fast, and how far, a follower may go."""

    def speed(self, time: float, along: float) -> float:
        """Wanted speed [m/s] at a time [s] and an arc length [m]."""

    def known(self, time: float) -> float:
        """Arc length [m] up to which the curve is known."""

    def over(self, time: float, along: float) -> bool:
        """Whether the end is reached."""


class SteadyPace:
    """One speed [m/s] to the end of a curve [m]."""

    def __init__(self, speed: float, length: float) -> None:
        self.set_speed, self.length = speed, length

    def speed(self, time: float, along: float) -> float:
        return self.set_speed

    def known(self, time: float) -> float:
        return self.length

    def over(self, time: float, along: float) -> bool:
        return along >= self.length


class BehindVehicle:
    """The pace of a vehicle that has come `way` (T,) [m] at `time` (T,) [s], a set distance [m] behind it.

    Its speed and what is missing of the distance: U = U_l + k (s_l − b − s), from 0 to `fastest` [m/s].
    """

    def __init__(self, time: Array, way: Array, behind: float, fastest: float) -> None:
        self.time, self.way, self.behind, self.fastest = time, way, behind, fastest
        self.rate = np.gradient(way, time)

    def speed(self, time: float, along: float) -> float:
        leader = float(np.interp(time, self.time, self.rate)) if time < self.time[-1] else 0.0
        missing = self.known(time) - self.behind - along
        return min(max(leader + CATCHING * missing, 0.0), self.fastest)

    def known(self, time: float) -> float:
        return float(np.interp(time, self.time, self.way))

    def outrun(self) -> tuple[float, float]:
        """Distance [m] by which the vehicle outruns a boat at `fastest`, and its mean speed [m/s] there."""
        ahead = self.way - self.fastest * self.time
        end = int(np.argmax(ahead - np.minimum.accumulate(ahead)))
        start = int(np.argmin(ahead[: end + 1]))
        taken = float(self.time[end] - self.time[start])
        speed = float(self.way[end] - self.way[start]) / taken if taken else 0.0
        return float(ahead[end] - ahead[start]), speed

    def over(self, time: float, along: float) -> bool:
        return bool(time >= self.time[-1] and along >= self.way[-1] - self.behind)


class CurveFollower:
    """Follows a curve at a pace [m/s] over ground, and stops thrusting at its end.

    Line of sight on the curve's tangent, heading = course − atan(e / Δ) − β with the drift angle β (Fossen
    2011, 10.75), and the curve's own yaw rate κ U beside; this one is read `LEAD` ahead. Surge force and yaw
    moment are wanted, sway force is not, so any drive serves. length [m]: of the boat.
    """

    def __init__(
        self, drive: Drive, servo: VelocityServo, curve: Curve, pace: Pace, length: float = SWAMP_LENGTH
    ) -> None:
        self.drive, self.servo, self.curve, self.pace = drive, servo, curve, pace
        self.scale = length / SWAMP_LENGTH
        self.slowest = slowest_speed(length)
        self.lookahead = LOOKAHEAD * self.scale
        self.along, self.drift, self.over = 0.0, 0.0, False

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]."""
        near = self.curve.nearest(seen.north, seen.east, self.along, self.lookahead)
        self.along = near.along
        self.over = self.over or self.pace.over(seen.time, self.along)
        if self.over:
            return np.concatenate([seen.azimuth, np.zeros(len(seen.azimuth))])
        speed = self.pace.speed(seen.time, self.along)
        ahead = min(self.along + LEAD * self.scale**0.5 * speed, self.pace.known(seen.time))
        bend = self.curve.curvature_at(ahead)
        if bend:
            speed = min(speed, SHARE * YAW_RATE_LIMIT / self.scale**0.5 / abs(bend))
        self._learn_drift(seen, dt)
        heading = self.curve.course_at(self.along) - math.atan2(near.across, self.lookahead) - self.drift
        turning = turning_to(heading, seen.heading, self.scale, bend * speed)
        return steered(self.drive, self.servo, speed, turning, seen, dt)

    def _learn_drift(self, seen: Seen, dt: float) -> None:
        """Average the angle from bow to course over ground; a boat at rest has none."""
        if seen.surge > self.slowest:
            share = min(dt / (DRIFT_TIME * self.scale**0.5), 1.0)
            self.drift += share * (math.atan2(seen.sway, seen.surge) - self.drift)
