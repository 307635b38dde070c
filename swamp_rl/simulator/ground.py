"""Water under the keel of a simulated boat, and the depth in its record."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.effects import LIBRARY
from swamp_rl.physics.compile import compiled
from swamp_rl.physics.motion import water_velocity
from swamp_rl.physics.squat import sinkage
from swamp_rl.simulator.state import HEADING, SURGE, SWAY, TIME


@compiled
def speed_in_water(state: Any, p: Any) -> float:
    """Speed [m/s] through the water of a boat in `state` (S,)."""
    north, east = water_velocity(state[TIME], p)
    cos, sin = math.cos(state[HEADING]), math.sin(state[HEADING])
    surge = state[SURGE] - (north * cos + east * sin)
    sway = state[SWAY] - (east * cos - north * sin)
    return math.sqrt(surge * surge + sway * sway)


@compiled
def squat_of(state: Any, p: Any, depth: float) -> float:
    """Sinkage [m] of a boat in `state` (S,) in water of a depth [m], at the load in its record p."""
    return sinkage(p.mass / p.water_density, p.length, speed_in_water(state, p), depth)


@compiled
def touches_ground(state: Any, p: Any, depth: float) -> bool:
    """Whether draught and squat of a boat in `state` (S,) reach a depth [m]; never where that is infinite."""
    if math.isinf(depth):
        return False
    return p.draught + squat_of(state, p, depth) >= depth


def deep() -> float:
    """Depth over draught [1] from which water counts as deep."""
    return LIBRARY["shallow_water"].parameter("depth_over_draught").neutral or math.inf


def tested(boat: Boat) -> float:
    """The least depth over draught [1] that the boat's resistance is known for."""
    given = boat.resistance
    return given.table[0].h_over_t if isinstance(given, TankResistance) else deep()


def in_tested_draughts(boat: Boat, depth: Any) -> Any:
    """A depth [m], any shape, over the draught [1], not less than the boat was towed in."""
    return np.maximum(depth / boat.draught, tested(boat))


def set_depth(params: NDArray[Any], boat: Boat, depth: float) -> None:
    """Put a depth [m] into the records, at the shallowest that the boat was towed in where it is less."""
    if math.isfinite(depth):
        params["depth_over_draught"] = in_tested_draughts(boat, depth)
