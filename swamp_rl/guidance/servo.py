"""The inner loop on velocities (thesis 6.4): forces that bring surge, sway and yaw rate to what is wanted."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.constants import SWAMP_LENGTH

Array = NDArray[np.float64]

DAMPING = 1.0  # of both poles: no overshoot of the linear loop
BANDWIDTH = (0.8, 0.8, 1.2)  # rad/s of surge, sway, yaw, of a boat as long as SWAMP
UNDER_WAY = 3.0  # rad per length sailed, of yaw at least: a hull's own yaw dynamics are as fast as U / L


def inertia_of(boat: Boat) -> Array:
    """(3,) mass, mass and moment of inertia with the water's: surge, sway [kg], yaw [kg m2]."""
    return np.array(
        [
            boat.mass - boat.added_mass_surge,
            boat.mass - boat.added_mass_sway,
            boat.inertia_z + boat.mass * boat.x_g**2 - boat.added_inertia_yaw,
        ]
    )


@dataclass
class VelocityServo:
    """Proportional and integral control of three velocities, each placed as a pair of poles.

    On the plant m dv/dt = force + steady push the loop is s^2 + 2 ζ ω s + ω^2 = 0, so with ω (3,) =
    `bandwidth` [rad/s] the push is forgotten. inertia: (3,); memory: (3,) the integral [N, N, N m]. Of a boat
    of `length` L [m], ω of yaw is at least `UNDER_WAY` U / L at a wanted surge speed U: a hull that does not
    keep its course by itself weaves under a slower loop.
    """

    inertia: Array
    bandwidth: Array = field(default_factory=lambda: np.array(BANDWIDTH))
    damping: float = DAMPING
    memory: Array = field(default_factory=lambda: np.zeros(3))
    length: float = math.inf

    def bandwidth_at(self, speed: float) -> Array:
        """(3,) [rad/s] at a wanted surge speed [m/s]."""
        yaw = max(self.bandwidth[2], UNDER_WAY * abs(speed) / self.length)
        return np.array([*self.bandwidth[:2], yaw])

    def force(self, wanted: Array, actual: Array) -> Array:
        """(3,) surge, sway force [N] and yaw moment [N m] for wanted and actual velocities (3,)."""
        gain = 2.0 * self.damping * self.bandwidth_at(wanted[0]) * self.inertia
        return gain * (wanted - actual) + self.memory

    def learn(self, wanted: Array, actual: Array, asked: Array, achieved: Array, dt: float) -> None:
        """Let dt [s] pass for the integral.

        It follows what was achieved of the force asked (3,), so that it does not wind up at the jets' limits.
        """
        bandwidth = self.bandwidth_at(wanted[0])
        towards = bandwidth**2 * self.inertia * (wanted - actual)
        lost = bandwidth / (2.0 * self.damping) * (achieved - asked)
        self.memory = self.memory + dt * (towards + lost)


def servo_of(boat: Boat) -> VelocityServo:
    """The inner loop of a boat, its bandwidth that of SWAMP by Froude's law."""
    bandwidth = np.array(BANDWIDTH) / (boat.length / SWAMP_LENGTH) ** 0.5
    return VelocityServo(inertia_of(boat), bandwidth, length=boat.length)
