"""Whether a boat's numbers fit its size: each as a ratio without dimension, with the range that is plausible.

The ranges are wide: they hold a toy of 0.3 m and a ship alike. What they refuse is nearly always a wrong unit
or a slipped decimal point.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from swamp_rl.boat.battery import PowerCurve, PowerTable, ShaftPower
from swamp_rl.boat.drawn import full_power
from swamp_rl.boat.estimate_drive import Sizes
from swamp_rl.boat.propeller_rudder import PropellerRudder
from swamp_rl.boat.quantity import units
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.boat.schema import Boat, Thruster
from swamp_rl.boat.screw import Screw
from swamp_rl.constants import GRAVITY, HEAVIEST_WATER, LIGHTEST_WATER

POWERS: dict[type, str] = {PowerCurve: "coefficient", PowerTable: "power", ShaftPower: "efficiency"}
UNITS = {"breadth": "m", "draught": "m", "mass": "kg", "water_density": "kg/m3"}
WATER = (LIGHTEST_WATER / 1000.0, HEAVIEST_WATER / 1000.0)
HULL = ("x_vr", "y_v", "y_r", "n_v", "n_r", "c_d", "c_ry", "c_rn")


class Limit(NamedTuple):
    """A number of the boat file by its dotted key, and the ratio [1] that must lie in [low, high]."""

    key: str
    value: float
    ratio: float
    what: str
    low: float
    high: float


def ranges(boat: Boat) -> Iterator[Limit]:
    """Every number that has a plausible range."""
    for part in (dimensions, mass_and_water, everything_else):
        yield from part(boat)


def implausible(boat: Boat) -> list[tuple[str, str]]:
    """Dotted key and complaint for each number that no boat of this size has.

    Where the dimensions, and then the mass, are not plausible, nothing is set against them.
    """
    unit_of = {".".join(key): unit for key, unit in units(boat)}
    parts = (part(boat) for part in (dimensions, mass_and_water, everything_else))
    return next(filter(None, (_faults(part, unit_of) for part in parts)), [])


def implausible_sizes(sizes: Boat | Sizes) -> list[tuple[str, str]]:
    """As `implausible`, of dimensions and mass alone: of a boat at a load, or to be estimated from them."""
    parts = (part(sizes) for part in (dimensions, mass_and_water))
    return next(filter(None, (_faults(part, UNITS) for part in parts)), [])


def _faults(limits: Iterable[Limit], unit_of: Mapping[str, str]) -> list[tuple[str, str]]:
    wrong = [limit for limit in limits if not limit.low <= limit.ratio <= limit.high]
    return [(limit.key, _complaint(limit, unit_of[limit.key])) for limit in wrong]


def _complaint(limit: Limit, unit: str) -> str:
    number = f"{limit.value:.6g}" if unit == "1" else f"{limit.value:.6g} {unit}"
    return (
        f"{number} is implausible: {limit.what} is {limit.ratio:.3g}; that of boats is "
        f"within [{limit.low:.3g}, {limit.high:.3g}]; check these numbers and their units"
    )


def dimensions(boat: Boat | Sizes) -> Iterator[Limit]:
    """Of length, breadth and draught."""
    yield Limit("breadth", boat.breadth, boat.breadth / boat.length, "breadth / length", 0.03, 2.0)
    yield Limit("draught", boat.draught, boat.draught / boat.length, "draught / length", 0.005, 0.6)


def mass_and_water(boat: Boat | Sizes) -> Iterator[Limit]:
    """Of the mass and the water that it displaces."""
    density = boat.water_density
    block = boat.mass / (density * boat.length * boat.breadth * boat.draught)
    yield Limit("water_density", density, density / 1000.0, "water_density / 1000 kg/m3", *WATER)
    what = "mass / (water_density length breadth draught)"
    yield Limit("mass", boat.mass, block, what, 0.02, 1.0)


def everything_else(boat: Boat) -> Iterator[Limit]:
    """Of all that is set against dimensions and mass."""
    for part in (inertia, drives, forces_on_hull, surroundings, electric):
        yield from part(boat)


def inertia(boat: Boat) -> Iterator[Limit]:
    """Of the moment of inertia, the centre of gravity and the added masses."""
    length, mass = boat.length, boat.mass
    corner = 0.5 * math.hypot(length, boat.breadth) / length  # all the mass at the corners
    turning = math.sqrt(boat.inertia_z / mass) / length
    yield Limit("inertia_z", boat.inertia_z, turning, "sqrt(inertia_z / mass) / length", 0.1, corner)
    yield Limit("x_g", boat.x_g, abs(boat.x_g) / length, "distance from midship / length", 0.0, 0.5)
    for name, most in (("added_mass_surge", 2.0), ("added_mass_sway", 5.0)):
        value = getattr(boat, name)
        yield Limit(name, value, -value / mass, f"-{name} / mass", 0.0, most)
    turning = -boat.added_inertia_yaw / (mass * length**2)
    what = "-added_inertia_yaw / (mass length^2)"
    yield Limit("added_inertia_yaw", boat.added_inertia_yaw, turning, what, 0.0, 1.0)


def forces_on_hull(boat: Boat) -> Iterator[Limit]:
    """Of the hull's coefficients and its resistance."""
    for name in HULL:
        value = getattr(boat.hull, name)
        yield Limit(f"hull.{name}", value, abs(value), "its magnitude", 0.0, 10.0)
    spacing = boat.hull.spacing
    yield Limit("hull.spacing", spacing, spacing / boat.breadth, "spacing / breadth", 0.0, 1.0)
    given = boat.resistance
    if isinstance(given, DriftResistance):
        for name in ("x_0_ahead", "x_0_astern"):
            value = getattr(given, name)
            yield Limit(f"resistance.{name}", value, -value, "its magnitude", 0.0, 2.0)
        return
    density = given.reference_density
    weight, wave = given.reference_mass * GRAVITY, math.sqrt(GRAVITY * boat.length)
    key = "resistance.reference_"
    loaded = given.reference_mass / boat.mass
    yield Limit(f"{key}mass", given.reference_mass, loaded, "reference_mass / mass", 0.2, 5.0)
    yield Limit(f"{key}density", density, density / 1000.0, "density / 1000 kg/m3", 0.9, 1.3)
    for i, curve in enumerate(given.table):
        key = f"resistance.table.{i}"
        for speed in (curve.speed[0], curve.speed[-1]):
            froude = speed / wave
            yield Limit(f"{key}.speed", speed, froude, "Froude number speed / sqrt(g length)", 0.001, 6.0)
        most = max(curve.resistance)
        yield Limit(f"{key}.resistance", most, most / weight, "resistance / weight", 1e-6, 2.0)


def surroundings(boat: Boat) -> Iterator[Limit]:
    """Of what wind and current meet."""
    wind, current = boat.wind, boat.current
    sides = {"frontal_area": boat.breadth, "lateral_area": boat.length}
    tall = max(boat.length, boat.breadth)
    for name, side in sides.items():
        value = getattr(wind, name)
        yield Limit(f"wind.{name}", value, value / (side * tall), "area / (width length)", 0.0, 5.0)
        value = getattr(current, name)
        share = value / (side * boat.draught)
        yield Limit(f"current.{name}", value, share, "area / (width draught)", 0.0, 3.0)
    for key, where in (("wind", wind.lateral_centre), ("current", current.lateral_centre)):
        off = abs(where) / boat.length
        yield Limit(f"{key}.lateral_centre", where, off, "distance from midship / length", 0.0, 0.5)
    coefficients = {f"wind.{name}": getattr(wind, name) for name in ("c_x", "c_y", "c_n")}
    coefficients |= {f"current.{name}": getattr(current, name) for name in ("c_x", "c_y")}
    for key, value in coefficients.items():
        yield Limit(key, value, abs(value), "its magnitude", 0.0, 5.0)
    yield Limit("wind.air_density", wind.air_density, wind.air_density, "density / 1 kg/m3", 0.5, 2.0)


def drives(boat: Boat) -> Iterator[Limit]:
    """Of thrusters, propellers and rudders."""
    for thruster in boat.thrusters:
        key = f"thrusters.{thruster.name}"
        place = f"{key}.rudder" if isinstance(thruster, PropellerRudder) else key
        off = abs(thruster.x) / boat.length
        yield Limit(f"{place}.x", thruster.x, off, "distance from midship / length", 0.0, 0.75)
        if isinstance(thruster, PropellerRudder):
            yield from _propeller(boat, thruster, key)
        else:
            yield from _jet(boat, thruster, key)


def _jet(boat: Boat, thruster: Thruster, key: str) -> Iterator[Limit]:
    weight = boat.mass * GRAVITY
    yield Limit(
        f"{key}.y", thruster.y, abs(thruster.y) / boat.breadth, "distance from midship / breadth", 0.0, 0.75
    )
    if thruster.propeller is not None:
        yield from _screw(boat, thruster.propeller, f"{key}.propeller")
    elif thruster.thrust_table is not None:
        for i, row in enumerate(thruster.thrust_table.rows):
            most = max(map(abs, row.thrust))
            yield Limit(
                f"{key}.thrust_table.rows.{i}.thrust", most, most / weight, "thrust / weight", 0.0, 3.0
            )
    else:
        for name in ("thrust_linear", "thrust_quadratic", "astern_linear", "astern_quadratic"):
            value = getattr(thruster, name)
            yield Limit(f"{key}.{name}", value, value / weight, "thrust / weight", 0.0, 3.0)
    under = boat.breadth * boat.draught
    area = thruster.nozzle_area
    yield Limit(f"{key}.nozzle_area", area, area / under, "area / (breadth draught)", 0.0, 1.0)
    if thruster.foil is not None:
        yield _lateral(boat, f"{key}.foil.area", thruster.foil.area)
    if thruster.kind == "azimuth":
        rate = thruster.azimuth_rate / (2.0 * math.pi)
        yield Limit(f"{key}.azimuth_rate", thruster.azimuth_rate, rate, "turns a second", 1e-4, 20.0)
    for name in ("azimuth_time_constant", "pump_time_constant"):
        yield _lag(boat, key, name, getattr(thruster, name))


def _screw(boat: Boat, screw: Screw, key: str) -> Iterator[Limit]:
    weight = boat.mass * GRAVITY
    share = screw.diameter / boat.length
    yield Limit(f"{key}.diameter", screw.diameter, share, "diameter / length", 0.001, 0.5)
    for name, astern in (("revolutions_max", False), ("revolutions_max_astern", True)):
        value = getattr(screw, name)
        heavy = screw.bollard(boat.water_density, astern) / weight
        if value > 0.0:
            yield Limit(f"{key}.{name}", value, heavy, "thrust / weight", 0.0, 3.0)
    yield Limit(f"{key}.side_share", screw.side_share, abs(screw.side_share), "its magnitude", 0.0, 1.0)
    if screw.motor is None:
        return
    full = screw.torque(screw.revolutions_max, boat.water_density)
    given = screw.motor.torque(2.0 * math.pi * screw.revolutions_max)
    what = "torque of the propeller at rest and revolutions_max / that of its motor there"
    ratio = full / given if given > 0.0 else math.inf
    yield Limit(f"{key}.motor.stall_torque", screw.motor.stall_torque, ratio, what, 0.0, 1.0)


def electric(boat: Boat) -> Iterator[Limit]:
    """Of the thrusters' electric power and the batteries."""
    for thruster in boat.thrusters:
        if thruster.power is not None:
            linear, quadratic = thruster.thrust_curve(boat.water_density)
            most = thruster.throttle_max
            thrust = linear * most + quadratic * most**2
            power = float(full_power(thruster, np.array(most), boat.water_density))
            name, what = POWERS[type(thruster.power)], "power / thrust at full throttle, W/N"
            key, value = f"thrusters.{thruster.name}.power.{name}", getattr(thruster.power, name)
            number = value[-1] if isinstance(value, tuple) else value
            yield Limit(key, number, power / thrust, what, 0.5, 500.0)
    battery = boat.battery
    if battery is None:
        return
    stored = battery.packs * battery.capacity * battery.voltage_full / boat.mass
    what = "energy of all packs / mass of the boat, J/kg"
    yield Limit("battery.capacity", battery.capacity, stored, what, 100.0, 1e6)
    for name in ("voltage_full", "voltage_empty"):
        value = getattr(battery, name)
        yield Limit(f"battery.{name}", value, value, "its magnitude", 1.0, 5000.0)
    for name in ("current_continuous", "current_peak"):
        value = getattr(battery, name)
        hours = battery.capacity / value / 3600.0
        yield Limit(f"battery.{name}", value, hours, "hours to empty a pack", 0.005, 1000.0)
    hotel = battery.hotel_power
    yield Limit("battery.hotel_power", hotel, hotel / boat.mass, "power / mass, W/kg", 0.0, 1000.0)


def _propeller(boat: Boat, thruster: PropellerRudder, key: str) -> Iterator[Limit]:
    propeller, area = thruster.propeller, thruster.rudder.area
    share = propeller.diameter / boat.length
    yield Limit(f"{key}.propeller.diameter", propeller.diameter, share, "diameter / length", 0.001, 0.5)
    yield _lateral(boat, f"{key}.rudder.area", area)
    thrust = thruster.thrust_curve(boat.water_density)[1] * thruster.revolutions_max**2
    heavy = thrust / (boat.mass * GRAVITY)
    yield Limit(f"{key}.revolutions_max", thruster.revolutions_max, heavy, "thrust / weight", 0.0, 3.0)
    rate = thruster.rudder_rate / (2.0 * math.pi)
    yield Limit(f"{key}.rudder_rate", thruster.rudder_rate, rate, "turns a second", 1e-4, 20.0)
    for name in ("rudder_time_constant", "revolutions_time_constant"):
        yield _lag(boat, key, name, getattr(thruster, name))


def _lateral(boat: Boat, key: str, area: float) -> Limit:
    """Of the area [m2] of a rudder or a foil."""
    return Limit(key, area, area / (boat.length * boat.draught), "area / (length draught)", 0.0, 1.0)


def _lag(boat: Boat, key: str, name: str, lag: float) -> Limit:
    """Set against the time in which the boat falls its own length; the shortest lag is followed exactly."""
    passing = math.sqrt(boat.length / GRAVITY)
    return Limit(f"{key}.{name}", lag, lag / passing, "lag / sqrt(length / g)", 0.0, 100.0)
