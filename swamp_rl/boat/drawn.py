"""Thrust at rest and electric power of one thruster against its command."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat.battery import PowerCurve, PowerTable
from swamp_rl.boat.propeller_rudder import PropellerRudder
from swamp_rl.boat.schema import Boat, Thruster
from swamp_rl.errors import UserError

Array = NDArray[np.float64]


def missing(boat: Boat) -> str | None:
    """The key of the boat file without which there are no electric figures; None where all are there."""
    for thruster in boat.thrusters:
        if thruster.power is None:
            return f"thrusters.{thruster.name}.power"
    return "battery" if boat.battery is None else None


def refuse_without_battery(boat: Boat, what: str = "energy") -> None:
    """UserError where the boat file lacks the battery or the power of a thruster, which `what` needs."""
    key = missing(boat)
    if key is not None:
        raise UserError(f"boat {boat.name}: {key}: is missing; {what} needs it, add it to the boat file")


def size_at_rest(thruster: Thruster | PropellerRudder, level: Array, density: float) -> Array:
    """Size [N] of the thrust at rest at commands `level`, any shape, without deduction.

    level: throttles [1], or revolutions [rps] of a propeller with a rudder.
    """
    ahead, astern = np.maximum(level, 0.0), np.maximum(-level, 0.0)
    if isinstance(thruster, PropellerRudder):
        propeller = thruster.propeller
        factors = (propeller.bollard_coefficient, propeller.bollard_coefficient_astern)
        forward, back = (density * propeller.diameter**4 * factor for factor in factors)
        return np.asarray(forward * ahead**2 + back * astern**2)
    if thruster.propeller is not None:
        forward, back = (thruster.propeller.bollard(density, way) for way in (False, True))
        return np.asarray(forward * ahead**2 + back * astern**2)
    if thruster.thrust_table is not None:
        throttles = thruster.thrust_table.throttles
        forces = [thruster.thrust_table.thrust_at_rest(throttle) for throttle in throttles]
        return np.asarray(np.abs(np.interp(level, throttles, forces)))
    forward_thrust = (thruster.thrust_linear + thruster.thrust_quadratic * ahead) * ahead
    return np.asarray(forward_thrust + (thruster.astern_linear + thruster.astern_quadratic * astern) * astern)


def full_power(
    thruster: Thruster | PropellerRudder, level: Array, density: float, left: Array | float = 1.0
) -> Array:
    """Electric power [W] at commands `level`, any shape; 0 for a thruster without `power`.

    P_0 + k (s T)^1.5, P(p) s^1.5 of a table less its P(0), or P_0 + s^1.5 2π n Q/η; s = left [1] is the share
    of its thrust at rest T that the voltage leaves.
    """
    given = thruster.power
    if given is None:
        return np.zeros(np.shape(level))
    if isinstance(given, PowerCurve):
        thrust = left * size_at_rest(thruster, level, density)
        return np.asarray(given.idle + given.coefficient * thrust**1.5)
    if isinstance(given, PowerTable):
        most = np.where(level >= 0.0, thruster.throttle_max, max(-thruster.throttle_min, 1e-9))
        rest = given.power[0]
        drawn = np.interp(np.abs(level) / most, given.throttle, given.power)
        return np.asarray(rest + (drawn - rest) * np.asarray(left) ** 1.5)
    assert isinstance(thruster, Thruster) and thruster.propeller is not None
    screw = thruster.propeller
    most = np.where(level >= 0.0, screw.revolutions_max, screw.revolutions_max_astern)
    n = np.abs(level) * most
    shaft = 2.0 * math.pi * n * screw.torque(n, density)
    return np.asarray(given.idle + shaft / given.efficiency * np.asarray(left) ** 1.5)
