"""From an order, one steering angle and one throttle, to the commands of whatever drives the boat."""

import math
from collections.abc import Callable, Collection, Iterable

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.boat.fixed_lever import fixed_lever
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.controller import Order, Pattern

Array = NDArray[np.float64]
Steering = Callable[[Order], Array]
STEEPEST = math.pi / 2  # beyond it a jet would push astern


def steering_limit(boat: Boat) -> float:
    """The largest steering angle [rad] that every actuator of the boat can take to either side."""
    limits = [STEEPEST]
    for thruster in boat.thrusters:
        if isinstance(thruster, PropellerRudder):
            limits.append(thruster.rudder_max)
        elif thruster.kind == "azimuth":
            limits += [-thruster.azimuth_min, thruster.azimuth_max]
    return max(min(limits), 0.0)


def steering(boat: Boat, pattern: Pattern) -> Steering:
    """Commands (2K,), angles [rad] then throttles or revolutions, for an order to this boat.

    Azimuth thrusters: `opposed` turns those forward of midship by the angle and those aft of it by its
    opposite; `bow` uses the forward ones alone, as the joypad did at Camogli; `parallel` turns all the same
    way, which pushes the boat aside. A rudder takes the angle. Fixed thrusters steer by their difference:
    the inner side is throttled down, to nothing at 90 degrees; those that push abeam, such as a tunnel
    thruster, stay at rest. UserError where the boat cannot do so.
    """
    _refuse_impossible(boat, pattern)
    return commands_of(boat, pattern)


def commands_of(boat: Boat, pattern: Pattern) -> Steering:
    """As `steering`, for any boat: what cannot turn it is ordered all the same."""
    parts = [_propeller(t) if isinstance(t, PropellerRudder) else _jet(t, pattern) for t in boat.thrusters]

    def commands(order: Order) -> Array:
        pairs = [part(order) for part in parts]
        return np.array([angle for angle, _ in pairs] + [level for _, level in pairs])

    return commands


def _refuse_impossible(boat: Boat, pattern: Pattern) -> None:
    jets = [t for t in boat.thrusters if isinstance(t, Thruster)]
    if pattern == "bow" and not any(t.x > 0.0 and t.kind == "azimuth" for t in jets):
        raise UserError(
            f"pattern bow: boat {boat.name} has no azimuth thruster forward of midship; use opposed"
        )
    steers = [t for t in jets if (t.x if t.kind == "azimuth" else math.prod(fixed_lever(t))) != 0.0]
    if not steers and len(jets) == len(boat.thrusters):
        raise UserError(f"boat {boat.name}: no thruster of it turns the boat; a trial needs one that does")


def _rests(thruster: Thruster | PropellerRudder) -> bool:
    """Whether it is fixed and pushes abeam, so that a trial leaves it at rest."""
    return isinstance(thruster, Thruster) and thruster.kind == "fixed" and fixed_lever(thruster)[0] == 0.0


def refuse_astern(boat: Boat, names: Collection[str] | None = None) -> None:
    """UserError where some actuator of the boat, of those named, cannot push astern."""
    for thruster in boat.thrusters:
        if _rests(thruster) or (names is not None and thruster.name not in names):
            continue
        if isinstance(thruster, PropellerRudder):
            able = thruster.revolutions_max_astern > 0.0
        else:
            able = _turns_round(thruster) or thruster.reverses
        if not able:
            raise UserError(
                f"boat {boat.name}: {thruster.name} cannot push astern; this trial needs a boat that can"
            )


def _turns_round(thruster: Thruster) -> bool:
    return thruster.kind == "azimuth" and thruster.azimuth_max >= math.pi + STEEPEST


Part = Callable[[Order], tuple[float, float]]


def _propeller(actuator: PropellerRudder) -> Part:
    def part(order: Order) -> tuple[float, float]:
        if order.astern:
            return -order.angle, -order.throttle * actuator.revolutions_max_astern
        return order.angle, order.throttle * actuator.revolutions_max

    return part


def _jet(thruster: Thruster, pattern: Pattern) -> Part:
    if thruster.kind == "fixed":
        return _fixed(thruster)
    side = 1.0 if pattern == "parallel" else float(np.sign(thruster.x))
    share = 0.0 if pattern == "bow" and thruster.x <= 0.0 else 1.0
    turns_round = _turns_round(thruster)

    def part(order: Order) -> tuple[float, float]:
        angle, level = side * order.angle * share, share * order.throttle
        if not order.astern:
            return angle, level
        # A mirrored angle keeps the sideways push, and with it the turn, as it was ahead.
        return (math.pi - angle, level) if turns_round else (-angle, -level)

    return part


def _fixed(thruster: Thruster) -> Part:
    ahead, turn = fixed_lever(thruster)

    def part(order: Order) -> tuple[float, float]:
        way = -ahead if order.astern else ahead
        inner = max(-way * turn * order.angle, 0.0)
        return thruster.azimuth_min, way * order.throttle * (1.0 - min(inner / STEEPEST, 1.0))

    return part


def difference_angle(driven: Iterable[tuple[Thruster | PropellerRudder, Array]]) -> Array | None:
    """Steering angle (T,) [rad] that gives fixed thrusters these throttles (T,), the inverse of `_fixed`.

    90 degrees where the inner side is at rest or pushes the other way, 0 where no thruster pushes; None for
    thrusters that do not turn the boat to both sides.
    """
    sides: dict[float, list[Array]] = {1.0: [], -1.0: []}
    for thruster, level in driven:
        if isinstance(thruster, Thruster) and thruster.kind == "fixed":
            ahead, turn = fixed_lever(thruster)
            if ahead * turn != 0.0:
                sides[ahead * turn].append(ahead * level)
    if not all(sides.values()):
        return None
    starboard, port = (np.mean(sides[turn], axis=0) for turn in (1.0, -1.0))
    outer = np.maximum(np.abs(starboard), np.abs(port))
    return STEEPEST * np.clip((starboard - port) / np.where(outer > 0.0, outer, 1.0), -1.0, 1.0)
