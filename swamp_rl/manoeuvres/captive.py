"""Captive trials: the boat held at an imposed speed, its thrusters running, the carriage's force recorded.

Bollard pull and towed self-propulsion test (thesis 7.3.4), by the compiled forces of the simulator. Water
and air are still, the velocity is constant and along the hull, the actuators have settled; the boat file's
effects act as they do at time 0. Forces along the hull are positive the way that the boat is towed.
"""

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.constants import GRAVITY
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import commands_of, refuse_astern
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.propeller import astern_thrust, open_water_thrust
from swamp_rl.physics.propulsion import propulsion_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.physics.thrusters import bollard_thrust
from swamp_rl.simulator import initial_state, parameters, tank
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.step import SUBSTEP, commanded, forget_outputs, move_actuators

Array = NDArray[np.float64]


class Point(NamedTuple):
    """One captive run.

    thrusters: those that ran; throttle: share of full [1]; speed [m/s]; resistance [N]: of the hull alone, R;
    towing_force [N]: the carriage's with the thrusters running, F_D; bollard_thrust [N]: of these thrusters
    by the boat file's curve, along the hull, at rest and without deduction; side_force [N] to starboard and
    yaw_moment [N m]: of the boat on the carriage.
    """

    thrusters: tuple[str, ...]
    throttle: float
    speed: float
    resistance: float
    towing_force: float
    bollard_thrust: float
    side_force: float
    yaw_moment: float

    @property
    def thrust(self) -> float:
        """R - F_D [N], what the thrusters add to the boat; at rest the pull on the line."""
        return self.resistance - self.towing_force

    @property
    def thrust_factor(self) -> float:
        """1 - t = (R - F_D) / T_bollard [1] (eq. 7.1); not a number without thrust."""
        return self.thrust / self.bollard_thrust if self.bollard_thrust != 0.0 else math.nan


def captive_trial(
    boat: Boat,
    speeds: Sequence[float],
    throttles: Sequence[float],
    sets: Sequence[tuple[str, ...]],
    astern: bool = False,
) -> list[Point]:
    """A run for every set of thrusters, speed [m/s] and throttle [1], the throttle changing fastest.

    UserError for a throttle or a speed that the boat has not, one given twice, or thrusters that cannot push
    astern.
    """
    _refuse_twice("throttle", [f"{throttle:g}" for throttle in throttles])
    _refuse_twice("speed", [f"{speed:g}" for speed in speeds])
    for throttle in throttles:
        if not 0.0 <= throttle <= 1.0:
            raise UserError(f"throttle {throttle:g}: is a share of full throttle, from 0 to 1")
    most = fastest(boat)
    for speed in speeds:
        if not 0.0 <= speed <= most:
            raise UserError(
                f"speed {speed:g} m/s: boat {boat.name} can be towed from 0 to {most:.4g} m/s, as far as its "
                "resistance is known"
            )
    if astern:
        refuse_astern(boat, {name for names in sets for name in names})
    return [
        captive_point(boat, speed, throttle, names, astern)
        for names in sets
        for speed in speeds
        for throttle in throttles
    ]


def captive_point(
    boat: Boat, speed: float, throttle: float, names: Sequence[str], astern: bool = False
) -> Point:
    """One captive run at a speed [m/s] and a throttle [1] of the named thrusters, all others stopped."""
    command = command_of(boat, throttle, names, astern)
    way = -1.0 if astern else 1.0
    resistance = resistance_at(boat, way * speed)
    surge, sway, yaw = forces(boat, way * speed, command)
    curve = way * thrust_at_rest(boat, command)
    return Point(tuple(names), throttle, speed, resistance, -way * surge, curve, sway, yaw)


def command_of(boat: Boat, throttle: float, names: Sequence[str], astern: bool = False) -> Array:
    """(2K,) settled angles [rad] and throttles [1] or revolutions [rps]: those named push along the hull.

    The others are stopped.
    """
    ordered = commands_of(boat, "opposed")(Order(0.0, throttle, astern))
    runs = np.isin(boat.thruster_names, list(names))
    ordered[len(runs) :] *= runs
    return settled(boat, ordered)


def settled(boat: Boat, command: Array) -> Array:
    """(2K,) where the actuators come to rest under a command (2K,): within their limits."""
    record = parameters(boat)[0]
    return np.array([commanded(k, 0.0, command, record) for k in range(len(boat.thrusters))]).T.ravel()


def forces(boat: Boat, surge: float, command: Array) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of hull and thrusters at a speed [m/s].

    command: (2K,), settled.
    """
    return forces_of(parameters(boat), tank(boat), surge, command)


def forces_of(
    params: NDArray[Any], curves: Array, surge: float, command: Array
) -> tuple[float, float, float]:
    """As `forces`, of the boat of a parameter record (1,) with its towing tank."""
    record, state = params[0], initial_state(params, np.zeros((1, 3)))[0]
    state[ACTUATORS:] = command
    outputs = np.empty((3, len(command) // 2, JET))
    forget_outputs(outputs)
    move_actuators(state, command, SUBSTEP, outputs, record)
    hull = hull_forces(surge, 0.0, 0.0, record, curves, towing(record, curves))
    driven = propulsion_forces(outputs, 0, surge, 0.0, 0.0, record)
    x, y, n = (float(a) + float(b) for a, b in zip(hull, driven, strict=True))
    return x, y, n


def thrust_at_rest(boat: Boat, command: Array) -> float:
    """Thrust [N] along the hull by the boat file's curves, at rest and without deduction, negative astern."""
    record = parameters(boat)[0]
    total = 0.0
    for k, (angle, level) in enumerate(command.reshape(2, -1).T):
        if not isinstance(boat.thrusters[k], PropellerRudder):
            total += bollard_thrust(level, k, record) * math.cos(angle)
        elif level != 0.0:
            total += (open_water_thrust if level > 0.0 else astern_thrust)(level, 0.0, k, record)
    return float(total)


def resistance_at(boat: Boat, speed: float) -> float:
    """Resistance [N] of the hull towed straight at a speed [m/s], negative astern."""
    record, curves = parameters(boat)[0], tank(boat)
    surge, _, _ = hull_forces(speed, 0.0, 0.0, record, curves, towing(record, curves))
    return abs(float(surge))


def bollard_of_all(boat: Boat, throttle: float) -> float:
    """Thrust [N] at rest of all thrusters at one throttle [1], without deduction."""
    return thrust_at_rest(boat, command_of(boat, throttle, boat.thruster_names))


def self_propulsion(boat: Boat, speed: float, names: Sequence[str], astern: bool = False) -> float:
    """Throttle [1] of the named thrusters that needs no towing force; not a number beyond full throttle."""
    from scipy.optimize import brentq

    def towing_force(throttle: float) -> float:
        return captive_point(boat, speed, throttle, names, astern).towing_force

    if towing_force(1.0) > 0.0 or speed == 0.0:
        return math.nan
    return float(brentq(towing_force, 0.0, 1.0, xtol=1e-6))


def fastest(boat: Boat) -> float:
    """The highest speed [m/s] that the resistance holds for: the tank's, or sqrt(g L) for coefficients."""
    given = boat.resistance
    if isinstance(given, TankResistance):
        return max(speed for curve in given.table for speed in curve.speed)
    return math.sqrt(GRAVITY * boat.length)


def thruster_sets(boat: Boat, given: Sequence[str] = ()) -> list[tuple[str, ...]]:
    """Sets of thrusters, each asked for by names (`bs,bp`) or by how many of the boat file's first.

    One, two, ... all of them where nothing is asked for. UserError for a thruster that is unknown or named
    twice, a number that the boat has not, or a set given twice.
    """
    names = boat.thruster_names
    sets = [_set_of(one, boat) for one in given] or [names[: n + 1] for n in range(len(names))]
    _refuse_twice("jets", [",".join(sorted(one, key=names.index)) for one in sets])
    return sets


def _set_of(given: str, boat: Boat) -> tuple[str, ...]:
    names, parts = boat.thruster_names, tuple(part.strip() for part in given.split(","))
    if len(parts) == 1 and parts[0].lstrip("-").isdecimal():
        if not 1 <= int(parts[0]) <= len(names):
            raise UserError(
                f"jets {given}: boat {boat.name} has {len(names)}; give 1 to {len(names)}, or names"
            )
        return names[: int(parts[0])]
    for part in parts:
        if part not in names:
            raise UserError(
                f"jets {given}: boat {boat.name} has no thruster {part!r}; it has {', '.join(names)}"
            )
    _refuse_twice(f"jets {given}: thruster", parts)
    return parts


def _refuse_twice(what: str, given: Sequence[str]) -> None:
    for one, times in Counter(given).items():
        if times > 1:
            raise UserError(f"{what} {one}: is given twice; give it once")
