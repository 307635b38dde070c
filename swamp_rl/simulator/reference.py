"""A boat's reference quantities, by which sizes, bounds and thresholds follow the boat instead of SWAMP."""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.constants import FASTEST, GRAVITY
from swamp_rl.effects import Reference
from swamp_rl.effects.fit import Size
from swamp_rl.physics.force_curve import ANGLE_OF_THRUSTER, JET
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.propulsion import actuator_output, propulsion_forces, throttle_limits
from swamp_rl.physics.resistance import towing
from swamp_rl.physics.thrusters import put_output
from swamp_rl.simulator.parameters import parameters, tank

HALVINGS = 40


@lru_cache(maxsize=64)
def reference_of(boat: Boat) -> Reference:
    """Length, breadth, mass, and what full command ahead gives: thrust T of all thrusters together at rest
    and top speed U, X_jets(U) + X_hull(U) = 0.

    Where the thrusters cannot push ahead, T is the sum of their forces, and U the speed at which the
    resistance equals it.
    """
    record, curves = parameters(boat)[0], tank(boat)
    outputs = _full_ahead(record)
    together = propulsion_forces(outputs, 0, 0.0, 0.0, 0.0, record)
    pushes = together[0] > 0.0
    thrust = math.hypot(*together[:2]) if pushes else _magnitudes(outputs, record)
    tow = towing(record, curves)

    def net(u: float) -> float:
        drive = propulsion_forces(outputs, 0, u, 0.0, 0.0, record)[0] if pushes else thrust
        return float(drive + hull_forces(u, 0.0, 0.0, record, curves, tow)[0])

    low, high = 0.0, FASTEST * math.sqrt(GRAVITY * boat.length)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if net(middle) > 0.0 else (low, middle)
    return Reference(boat.length, boat.breadth, boat.mass, high, thrust)


def size_of(boat: Boat) -> Size:
    """What a level of disturbances is proportioned to."""
    return Size(boat.length, reference_of(boat).speed, boat.mass)


def _full_ahead(record: Any) -> NDArray[np.float64]:
    """(1, K, JET) outputs of thrusters at their greatest command, as nearly straight ahead as they turn."""
    outputs = np.zeros((1, len(record["thruster_x"]), JET))
    for k in range(outputs.shape[1]):
        angle = float(np.clip(0.0, record["azimuth_min"][k], record["azimuth_max"][k]))
        first, second = actuator_output(angle, throttle_limits(k, record)[1], k, record)
        put_output(first, second, outputs, 0, k, record)
        outputs[0, k, ANGLE_OF_THRUSTER] = angle
    return outputs


def _magnitudes(outputs: NDArray[np.float64], record: Any) -> float:
    """Sum of the forces [N] of each thruster alone, at rest."""
    total = 0.0
    for k in range(outputs.shape[1]):
        alone = np.zeros_like(outputs)
        alone[0, k] = outputs[0, k]
        total += math.hypot(*propulsion_forces(alone, 0, 0.0, 0.0, 0.0, record)[:2])
    return total
