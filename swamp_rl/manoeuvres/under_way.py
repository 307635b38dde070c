"""A boat under way in still water and air, where experiments on its steering begin."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.simulator import initial_state
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import ACTUATORS, SURGE

Array = NDArray[np.float64]

WEATHER = ("wind_speed", "current_north", "current_east", "current_north_rate", "current_east_rate")


def under_way(
    boat: Boat, params: NDArray[Any], count: int, command: Array, throttle: float = 1.0
) -> tuple[NDArray[Any], Array]:
    """Records without weather (count,), from that of the boat (1,), and states (count, S) at the share
    `throttle` of the top speed, all actuators at a command (2K,).
    """
    calm = np.repeat(params, count)
    for field in WEATHER:
        calm[field] = 0.0
    state = initial_state(calm, np.zeros((count, 3)))
    state[:, SURGE] = reference_of(boat).speed * throttle
    state[:, ACTUATORS : ACTUATORS + len(command)] = command
    return calm, state
