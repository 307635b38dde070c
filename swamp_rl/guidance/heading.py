"""Heading control: from the course wanted to the angle that the boat steers with."""

import math

from swamp_rl.angles import wrapped
from swamp_rl.constants import GRAVITY

STIFFNESS, DAMPING = 2.0, 8.0
"Steering angle per heading error [1], and per yaw rate in lengths sailed [1]."
SLOWEST = 0.03  # Froude number below which the damping grows no more: a boat at rest has no length per second


def slowest_speed(length: float) -> float:
    """Speed [m/s] below which a boat of that length [m] counts as hardly moving."""
    return SLOWEST * math.sqrt(GRAVITY * length)


def steering_angle(
    wanted: float, heading: float, yaw_rate: float, speed: float, length: float, limit: float
) -> float:
    """Steering angle [rad], positive turning the bow to starboard, that brings `heading` to `wanted` [rad].

    Proportional to the error, with damping by the yaw rate [rad/s] in lengths sailed, r L / U, so that one
    pair of gains serves boats of any size and speed. speed U [m/s], length L [m]; within `limit` either way.
    """
    turning = yaw_rate * length / max(speed, slowest_speed(length))
    angle = STIFFNESS * wrapped(wanted - heading) - DAMPING * turning
    return min(max(angle, -limit), limit)
