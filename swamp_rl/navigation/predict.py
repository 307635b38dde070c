"""How the filter's state moves on between readings: by the boat's model and its commands, or by coasting."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.state import ACTUATORS, TIME
from swamp_rl.simulator.substeps import longest_substep, substeps_in

Array = NDArray[np.float64]

STATES = 8  # north, east [m], heading [rad], surge, sway [m/s over ground], yaw rate [rad/s], current [m/s]
DIFFERENCE = np.array([1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4])
NINE = np.vstack([np.zeros(STATES), np.diag(DIFFERENCE)])


class Predictor(Protocol):
    """Moves a state (8,) on by dt [s] and says by what Jacobian (8, 8)."""

    def predict(self, x: Array, commands: Array, dt: float) -> tuple[Array, Array]:
        """The state dt [s] later under commands (2K,), and its derivative by the state now."""


class Coasting:
    """Dead reckoning without a model: the velocities over ground stay what they are."""

    def predict(self, x: Array, commands: Array, dt: float) -> tuple[Array, Array]:
        """The boat goes straight on along its heading in the middle of the step."""
        heading = x[2] + 0.5 * dt * x[5]
        cos, sin = np.cos(heading), np.sin(heading)
        north, east = x[3] * cos - x[4] * sin, x[3] * sin + x[4] * cos
        moved = x + dt * np.array([north, east, x[5], 0.0, 0.0, 0.0, 0.0, 0.0])
        slopes = np.eye(STATES)
        slopes[0, 2:6] = dt * np.array([-east, cos, -sin, -0.5 * dt * east])
        slopes[1, 2:6] = dt * np.array([north, sin, cos, 0.5 * dt * north])
        slopes[2, 5] = dt
        return moved, slopes


class BoatModel:
    """The compiled simulator itself, thrusters and hull, in the current that the filter believes in.

    The actuators follow the commands without doubt; the wind is the boat file's.
    """

    def __init__(self, boat: Boat) -> None:
        self.boat, self.tank = boat, tank(boat)
        self.params = parameters(boat, STATES + 1)
        "Records of the state and of its differences; a caller may put others there."
        self.actuators = initial_state(self.params[:1], np.zeros((1, 3)))[0]
        self._states = np.zeros((STATES + 1, len(self.actuators)))
        self._commands = np.zeros((STATES + 1, len(self.actuators) - ACTUATORS))
        self._seeds = np.zeros(STATES + 1, np.uint64)
        self._longest = longest_substep(boat)

    def predict(self, x: Array, commands: Array, dt: float) -> tuple[Array, Array]:
        """Nine boats at once: the state and one for each of its differences."""
        tried, states = x + NINE, self._states
        states[:] = self.actuators
        states[:, :6] = tried[:, :6]
        self.params["current_north"], self.params["current_east"] = tried[:, 6], tried[:, 7]
        self._commands[:] = commands
        step(states, self.params, self.tank, self._commands, self._seeds, dt, substeps_in(dt, self._longest))
        self.actuators[ACTUATORS:] = states[0, ACTUATORS:]
        self.actuators[TIME] = states[0, TIME]
        tried[:, :6] = states[:, :6]
        return tried[0].copy(), ((tried[1:] - tried[0]) / DIFFERENCE[:, None]).T
