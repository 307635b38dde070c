"""What the pilots' arithmetic shares: the array type, the ends of the levers' ways, the wrap of an angle."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

LOWEST, HIGHEST = np.array([0.0, -1.0]), np.array([1.0, 1.0])
"Ends of the levers' ways: throttle, angle [1]."


def wrap(angle: Array) -> Array:
    """The angle [rad], any shape, brought into [-pi, pi)."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi


def levers_of(actions: Array) -> Array:
    """Levers (..., 2) from actions in [-1, 1], which reach over the whole way of each; what is beyond stops
    at the end."""
    middle, reach = 0.5 * (HIGHEST + LOWEST), 0.5 * (HIGHEST - LOWEST)
    return middle + reach * np.clip(actions, -1.0, 1.0)
