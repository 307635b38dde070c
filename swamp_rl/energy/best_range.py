"""Energy per metre at a steady speed, and the speed at which it is least."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.energy.power import pack_power
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.captive import self_propulsion
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

SLOWEST = 0.05  # of the top speed, from which the best is sought


def steady_power(boat: Boat, speed: float) -> Array:
    """Power [W] (packs,) at a steady speed [m/s] in still water, all thrusters at one throttle.

    UserError for a speed that the boat cannot reach, or where its file lacks battery or power.
    """
    throttle = self_propulsion(boat, speed, boat.thruster_names)
    if math.isnan(throttle):
        raise UserError(f"boat {boat.name}: cannot reach {speed:g} m/s; go slower")
    return pack_power(boat, throttle * np.array([thruster.throttle_max for thruster in boat.thrusters]))


def energy_per_metre_at(boat: Boat, speed: float) -> float:
    """Energy [J/m] that all packs give for each metre at a steady speed [m/s] in still water: ΣP / U."""
    return float(steady_power(boat, speed).sum() / speed)


def best_range_speed(boat: Boat) -> float:
    """Speed [m/s] of the least energy per metre in still water."""
    from scipy.optimize import minimize_scalar

    top = reference_of(boat).speed
    found = minimize_scalar(
        lambda speed: energy_per_metre_at(boat, float(speed)),
        bounds=(SLOWEST * top, 0.999 * top),
        method="bounded",
        options={"xatol": 1e-4},
    )
    return float(found.x)
