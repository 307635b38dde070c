"""Heading control: from the course wanted to the angle that the boat steers with."""

import math
from typing import NamedTuple

from swamp_rl.angles import wrapped
from swamp_rl.constants import GRAVITY

STIFFNESS, DAMPING = 2.0, 8.0
"Steering angle per heading error [1], and per yaw rate in lengths sailed [1]."
SLOWEST = 0.03  # Froude number below which the damping grows no more: a boat at rest has no length per second


class Limits(NamedTuple):
    """What a boat's steering allows: `angle` [rad] to either side, and `gain` [s], the most steering angle
    per yaw rate at which its lags leave the loop stable.
    """

    angle: float
    gain: float = math.inf


def slowest_speed(length: float) -> float:
    """Speed [m/s] below which a boat of that length [m] counts as hardly moving."""
    return SLOWEST * math.sqrt(GRAVITY * length)


def steering_angle(
    wanted: float, heading: float, yaw_rate: float, speed: float, length: float, limits: Limits
) -> float:
    """Steering angle [rad], positive turning the bow to starboard, that brings `heading` to `wanted` [rad].

    Proportional to the error, with damping by the yaw rate [rad/s] in lengths sailed, r L / U, so that one
    pair of gains serves boats of any size and speed; both are smaller, in the same ratio, where the boat
    turns too fast for them. speed U [m/s], length L [m].
    """
    sailed = length / max(speed, slowest_speed(length))  # s
    gain = min(DAMPING * sailed, limits.gain)
    turn = STIFFNESS / DAMPING * wrapped(wanted - heading) / sailed  # rad/s that are wanted
    angle = gain * (turn - yaw_rate)
    return min(max(angle, -limits.angle), limits.angle)
