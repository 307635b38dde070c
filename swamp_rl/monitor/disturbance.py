"""The boat's model under an unknown force: a Gauss-Markov acceleration, as wind and its gusts make it.

Three more states of the filter: the acceleration to the north and east [m/s2] and in yaw [rad/s2], each a
Gauss-Markov process of first order (Gelb 1974, ch. 3.8). The filter follows the force of the wind, and the
innovations stay white.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.navigation.predict import STATES, BoatModel
from swamp_rl.physics.compile import compiled
from swamp_rl.simulator.state import HEADING, SURGE

Array = NDArray[np.float64]

FORCED = STATES + 3  # states of the filter: those of navigation, then the accelerations


@dataclass(frozen=True)
class ProcessNoise:
    """walk: (8,) random walk of the states of navigation [unit/sqrt(s)]; strength: (3,) standard deviation of
    the accelerations; time_constant: theirs [s].
    """

    walk: Array
    strength: Array
    time_constant: float

    def times(self, multiple: float) -> "ProcessNoise":
        """Process noise of so many times the standard deviation."""
        return ProcessNoise(multiple * self.walk, multiple * self.strength, self.time_constant)

    def at_least(self, other: "ProcessNoise") -> "ProcessNoise":
        """The greater standard deviation of both, with this one's time constant."""
        walk, strength = np.maximum(self.walk, other.walk), np.maximum(self.strength, other.strength)
        return ProcessNoise(walk, strength, self.time_constant)

    @property
    def walks(self) -> Array:
        """(11,) random walk of all states."""
        return np.append(self.walk, np.sqrt(2.0 / self.time_constant) * self.strength)


class ForcedModel:
    """Moves the state (11,) of the filter on; `model` moves that of navigation."""

    def __init__(self, model: BoatModel, time_constant: float) -> None:
        self.model, self.time_constant = model, time_constant

    def predict(self, x: Array, commands: Array, dt: float) -> tuple[Array, Array]:
        """The state dt [s] later under commands (2K,), and its Jacobian (11, 11)."""
        moved, own = self.model.predict(x[:STATES], commands, dt)
        return forced(x, moved, own, dt, self.time_constant)


@compiled
def forced(x: Any, moved: Any, own: Any, dt: float, time_constant: float) -> Any:
    """State (11,) and Jacobian (11, 11) of a step from x (11,), of navigation's own (8,) and (8, 8)."""
    out, jacobian = np.zeros(FORCED), np.zeros((FORCED, FORCED))
    out[:STATES] = moved
    jacobian[:STATES, :STATES] = own
    cos, sin, keep = math.cos(x[HEADING]), math.sin(x[HEADING]), math.exp(-dt / time_constant)
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    for row in range(3):
        for column in range(3):
            out[SURGE + row] += dt * turn[row, column] * x[STATES + column]
            jacobian[SURGE + row, STATES + column] = dt * turn[row, column]
        out[STATES + row] = keep * x[STATES + row]
        jacobian[STATES + row, STATES + row] = keep
    jacobian[SURGE, HEADING] += dt * (cos * x[STATES + 1] - sin * x[STATES])
    jacobian[SURGE + 1, HEADING] -= dt * (cos * x[STATES] + sin * x[STATES + 1])
    return out, jacobian
