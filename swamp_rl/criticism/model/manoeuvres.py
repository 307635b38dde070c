"""Short open-loop manoeuvres, as commands, of which one is proposed to separate hypotheses."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.options import options
from swamp_rl.manoeuvres.captive import forces, settled
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.low_speed import astern, sideways, spin
from swamp_rl.manoeuvres.steering import commands_of
from swamp_rl.simulator import parameters
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

STEERED = 0.5  # rad of a circle's and a zig-zag's steering angle
UNDER_WAY = 0.5  # of the top speed, at which it is decided whether commands turn the boat


def manoeuvres(
    boat: Boat, dt: float, seconds: float | None = None, throttle: float = 1.0
) -> dict[str, Array]:
    """Commands (T, 2K) by name, in the boat's own units and within its limits, of those that it can do; their
    percentages are of a greatest throttle, a share of full [1].
    """
    seconds = options().trial_seconds if seconds is None else seconds
    time = np.arange(round(seconds / dt)) * dt
    to_starboard = np.sin(2 * math.pi * time / options().zig_zag_period) >= 0
    orders, count = commands_of(boat, "opposed"), len(boat.thrusters)

    def ahead(throttle: float) -> Array:
        return orders(Order(0.0, throttle))

    def stopped_after(end: float, throttle: float) -> Array:
        rows = np.tile(ahead(throttle), (len(time), 1))
        rows[time >= end, count:] = 0.0
        return rows

    found = {
        "straight ahead, 60 %": ahead(0.6),
        "straight ahead, 100 %": ahead(1.0),
        "straight ahead, then stopped": stopped_after(seconds / 2, 1.0),
    }
    circles = [orders(Order(angle, 0.6)) for angle in (STEERED, -STEERED)]
    if _turn_apart(boat, *circles):
        found["turning circle to starboard, 60 %"], found["turning circle to port, 60 %"] = circles
        sides = [orders(Order(angle, 0.8)) for angle in (STEERED, -STEERED)]
        found["zig-zag, 80 %"] = np.where(to_starboard[:, None], *sides)
    for name, command in (("spin", spin), ("astern", astern), ("sideways", sideways)):
        if (pushing := command(boat, 0.6)) is not None:
            found[name] = pushing
    sides = [_differential(boat, ahead(1.0), side) for side in (1.0, -1.0)]
    if _turn_apart(boat, *sides):
        found["differential thrust"] = np.where(to_starboard[:, None], *sides)
    found["adrift"] = stopped_after(10.0, 0.8)
    low, high = command_bounds(boat)
    for k, thruster in enumerate(boat.thrusters):
        alone = np.zeros(2 * count)
        alone[count + k] = 0.8 * high[count + k]
        found[f"{thruster.name} alone, 80 %"] = alone
    share = np.repeat([1.0, throttle], count)
    rows = {
        name: share * np.clip(np.broadcast_to(given, (len(time), 2 * count)), low, high)
        + 0.0  # no minus zero
        for name, given in found.items()
    }
    return {name: given for name, given in rows.items() if given[:, count:].any()}


def command_bounds(boat: Boat, throttle: float = 1.0) -> tuple[Array, Array]:
    """(2K,) least and greatest commands: angles [rad], of any number of turns the half to either side, and
    throttles [1] or revolutions [rps] up to a share of full.
    """
    record = parameters(boat)[0]
    angles = [np.clip(record[name], -math.pi, math.pi) for name in ("azimuth_min", "azimuth_max")]
    levels = [[one.throttle_min for one in boat.thrusters], [one.throttle_max for one in boat.thrusters]]
    return (
        np.concatenate([angles[0], throttle * np.array(levels[0])]),
        np.concatenate([angles[1], throttle * np.array(levels[1])]),
    )


def _turn_apart(boat: Boat, starboard: Array, port: Array) -> bool:
    """Whether two commands turn the boat under way, the first to starboard and the second to port."""
    speed = UNDER_WAY * reference_of(boat).speed
    first, second = (forces(boat, speed, settled(boat, command))[2] for command in (starboard, port))
    return first > 0.0 > second


def _differential(boat: Boat, ahead: Array, side: float) -> Array:
    """Full ahead at half the throttle, more of it on the side that turns the boat to starboard (side 1)."""
    count = len(boat.thrusters)
    angle, level = ahead[:count], ahead[count:]
    x, y = np.array([(thruster.x, thruster.y) for thruster in boat.thrusters]).T
    turn = np.sign(np.round(x * np.sin(angle) - y * np.cos(angle), 6) * level)
    return np.concatenate([angle, level * (0.5 + 0.3 * side * turn)])
