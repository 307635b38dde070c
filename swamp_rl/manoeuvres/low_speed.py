"""Commands that push a boat at rest astern or abeam, or turn it on the spot."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.throttle import throttle_for
from swamp_rl.boat import Boat, Thruster
from swamp_rl.boat.fixed_lever import fixed_lever
from swamp_rl.manoeuvres.captive import forces, settled
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import STEEPEST, commands_of
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

ASIDE = 0.25  # most of any other force, as a share of the wanted one; moments over half the boat's length


def astern(boat: Boat, throttle: float) -> Array | None:
    """Commands (2K,) astern at a share of full; None for a boat that cannot."""
    command = commands_of(boat, "opposed")(Order(0.0, throttle, astern=True))
    return command if _pushes(boat, command)[0] < 0.0 else None


def sideways(boat: Boat, throttle: float) -> Array | None:
    """Commands (2K,) that push to starboard at a share of full, hardly ahead and without turning; None for a
    boat that cannot.
    """
    across = {t.name: float(np.sign(round(math.sin(t.azimuth_min), 6))) for t in _fixed(boat)}
    command = commands_of(boat, "parallel")(Order(STEEPEST, throttle))
    command = _with_fixed(boat, command, across, throttle)
    ahead, abeam, turn = _pushes(boat, command)
    return command if abeam > 0.0 and max(abs(ahead), abs(turn)) <= ASIDE * abeam else None


def spin(boat: Boat, throttle: float) -> Array | None:
    """Commands (2K,) that turn to starboard at a share of full and hardly push ahead; None for a boat that
    cannot.
    """
    turning = {t.name: fixed_lever(t)[1] for t in _fixed(boat)}
    command = commands_of(boat, "opposed")(Order(STEEPEST, throttle))
    command = _with_fixed(boat, command, turning, throttle)
    ahead, _, turn = _pushes(boat, command)
    return command if turn > 0.0 and abs(ahead) <= ASIDE * turn else None


def _fixed(boat: Boat) -> list[Thruster]:
    return [t for t in boat.thrusters if isinstance(t, Thruster) and t.kind == "fixed"]


def _with_fixed(boat: Boat, command: Array, signs: dict[str, float], throttle: float) -> Array:
    """The command with each fixed thruster pushing by the sign of its throttle, all with the thrust of the
    weakest at that share of full: what they push ahead and astern is then balanced.
    """
    record, count = parameters(boat)[0], len(boat.thrusters)
    thrusts = {
        k: effective_thrust(signs[name] * throttle, k, record)
        for k, name in enumerate(boat.thruster_names)
        if name in signs
    }
    weakest = min((abs(thrust) for thrust in thrusts.values() if thrust != 0.0), default=0.0)
    balanced = command.copy()
    for k, thrust in thrusts.items():
        balanced[count + k] = throttle_for(float(np.sign(thrust)) * weakest, k, record)
    return balanced


def _pushes(boat: Boat, command: Array) -> tuple[float, float, float]:
    """Surge and sway force [N] at rest, and yaw moment over half the boat's length [N]."""
    surge, sway, yaw = forces(boat, 0.0, settled(boat, command))
    return surge, sway, yaw / (0.5 * boat.length)
