"""A GPS receiver and an AHRS at rates of their own: what they say of a true state, with their noise."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned, wrapped
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, YAW_RATE

Array = NDArray[np.float64]


class Fix(NamedTuple):
    """One reading: which of the filter's states it measures, the values, their standard deviations."""

    places: tuple[int, ...]
    values: Array
    deviations: Array


@dataclass(frozen=True)
class Sensors:
    """Standard deviations and intervals of a GPS (position, velocity) and an AHRS (heading and yaw rate).

    Our choice, of a plain receiver and a small inertial unit; not the instruments of SWAMP, whose data sheets
    the sources do not give.
    """

    position: float = 0.5  # m
    velocity: float = 0.05  # m/s over ground, north and east, by Doppler
    heading: float = 0.02  # rad
    yaw_rate: float = 0.01  # rad/s
    gps_interval: float = 0.4  # s
    ahrs_interval: float = 0.1  # s

    def gps(self, state: Array, rng: np.random.Generator) -> Fix:
        """Position of a state (S,)."""
        deviations = np.full(2, self.position)
        return Fix((0, 1), state[[NORTH, EAST]] + deviations * rng.standard_normal(2), deviations)

    def ahrs(self, state: Array, rng: np.random.Generator) -> Fix:
        """Heading, wrapped to (-pi, pi] as an instrument gives it, and yaw rate of a state (S,)."""
        deviations = np.array([self.heading, self.yaw_rate])
        values = state[[HEADING, YAW_RATE]] + deviations * rng.standard_normal(2)
        values[0] = wrapped(values[0])
        return Fix((2, 5), values, deviations)

    def motion(self, state: Array, rng: np.random.Generator) -> Array:
        """(6,) pose [m, m, rad], surge, sway over ground [m/s] and yaw rate [rad/s] of a state (S,).

        The GPS gives the velocity to the north and east: surge and sway hold the error of the heading too.
        """
        place, attitude = self.gps(state, rng).values, self.ahrs(state, rng).values
        north, east = turned(state[SURGE], state[SWAY], state[HEADING])
        off_north, off_east = self.velocity * rng.standard_normal(2)
        surge, sway = turned(north + off_north, east + off_east, -attitude[0])
        return np.array([*place, attitude[0], surge, sway, attitude[1]])


def due(interval: float, time: float, dt: float) -> bool:
    """Whether a sensor of that interval [s] reports in the step of dt [s] that ends at `time` [s]."""
    return int((time + 1e-9) / interval) > int((time - dt + 1e-9) / interval)
