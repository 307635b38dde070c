"""Squat of a boat under way in shallow water, and what is left under its keel."""

import math

from swamp_rl.boat.schema import Boat
from swamp_rl.constants import GRAVITY
from swamp_rl.physics.squat import sinkage


def critical_speed(depth: float) -> float:
    """√(g h) [m/s]: above it no formula of squat holds."""
    return math.sqrt(GRAVITY * depth)


def squat(boat: Boat, speed: float, depth: float) -> float:
    """Sinkage [m] of the lowest point at a speed [m/s] through water of a depth [m], by `physics.squat`.

    ValueError at and above the critical speed. The draught is not in it: `Boat.draught` is that of the load.
    """
    if speed >= critical_speed(depth) * (1.0 - 1e-9):
        raise ValueError(f"{speed:g} m/s is not below the critical speed of {critical_speed(depth):.3g} m/s")
    return sinkage(boat.mass / boat.water_density, boat.length, speed, depth)


def clearance(boat: Boat, speed: float, depth: float) -> float:
    """Water under the keel [m] at a speed [m/s] in a depth [m]: depth − draught − squat; negative aground.

    ValueError as `squat`.
    """
    return depth - boat.draught - squat(boat, speed, depth)
