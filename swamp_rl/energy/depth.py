"""Depth of the water along a mission: resistance in it, and where the boat touches ground."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.squat import clearance, critical_speed
from swamp_rl.energy.mission import Mission
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from swamp_rl.simulator.ground import deep, speed_in_water, squat_of, tested, touches_ground
from swamp_rl.simulator.state import EAST, NORTH, TIME

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Aground:
    """Where a boat touched ground: leg, time [s], place, depth, draught, squat [m], speed in water [m/s]."""

    leg: int
    time: float
    north: float
    east: float
    depth: float
    draught: float
    squat: float
    speed: float

    def __str__(self) -> str:
        return (
            f"aground after {self.time:.0f} s in legs.{self.leg}, at {self.north:.1f} m north, "
            f"{self.east:.1f} m east: {self.depth:.3g} m deep, draught {self.draught:.3g} m, squat "
            f"{1e3 * self.squat:.1f} mm at {self.speed:.2f} m/s"
        )


def depths(boat: Boat, mission: Mission) -> list[float]:
    """Depth [m] of the water on each leg; inf where it is deep, as far as mission and boat file say.

    That of the leg before where a leg has none; of the boat's own effect where none before has one.
    """
    own = float(parameters(boat)["depth_over_draught"][0])
    here = own * boat.draught if own < deep() else math.inf
    found = []
    for leg in mission.legs:
        here = here if leg.depth is None else leg.depth
        found.append(here)
    return found


def refuse_depths(boat: Boat, mission: Mission, where: object) -> None:
    """UserError for a leg above the critical speed, and for one in water shallower than the boat was towed in
    that does not touch ground."""
    for number, (leg, depth) in enumerate(zip(mission.legs, depths(boat, mission), strict=True)):
        if math.isinf(depth):
            continue
        if number == 0 and depth <= boat.draught:
            raise UserError(
                f"{where}: legs.0.depth: {depth:g} m is no more than the draught of {boat.draught:.3g} m of "
                f"boat {boat.name}: it lies aground; give more depth"
            )
        if leg.speed >= critical_speed(depth):
            raise UserError(
                f"{where}: legs.{number}.speed: {leg.speed:g} m/s is above the critical speed "
                f"{critical_speed(depth):.3g} m/s of {depth:g} m of water, where no squat is known; go slower"
            )
        if depth < tested(boat) * boat.draught * (1.0 - 1e-9) and clearance(boat, leg.speed, depth) > 0.0:
            raise UserError(
                f"{where}: legs.{number}.depth: {depth:g} m is {depth / boat.draught:.3g} draughts, and the "
                f"resistance of boat {boat.name} is known down to {tested(boat):.3g}; give more depth"
            )


def touched(boat: Boat, params: NDArray[Any], state: Array, leg: int, depth: float) -> Aground | None:
    """Where a boat in a state (S,) touches ground in water of a depth [m]; None where it floats."""
    if not touches_ground(state, params[0], depth):
        return None
    place = float(state[TIME]), float(state[NORTH]), float(state[EAST])
    sunk, speed = squat_of(state, params[0], depth), speed_in_water(state, params[0])
    return Aground(leg, *place, depth, float(params["draught"][0]), float(sunk), float(speed))
