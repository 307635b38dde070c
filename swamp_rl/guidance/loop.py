"""A controller and the compiled simulator in a closed loop."""

from collections.abc import Callable, Collection
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.state import ACTUATORS, NORTH, YAW_RATE
from swamp_rl.simulator.step import substeps_of

Array = NDArray[np.float64]


class Seen(NamedTuple):
    """What a controller knows: pose [m, m, rad], velocity over ground [m/s, rad/s], azimuths (K,) [rad]."""

    north: float
    east: float
    heading: float
    surge: float
    sway: float
    yaw_rate: float
    azimuth: Array

    @property
    def velocity(self) -> Array:
        """(3,) surge, sway, yaw rate."""
        return np.array([self.surge, self.sway, self.yaw_rate])


class Controller(Protocol):
    """Anything that turns what is seen into commands."""

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1], to be held for dt [s]."""


def truth(state: Array) -> Seen:
    """The state (S,) itself, as a perfect navigator would see it."""
    thrusters = (len(state) - ACTUATORS) // 2
    north, east, heading, surge, sway, yaw_rate = (float(state[i]) for i in range(NORTH, YAW_RATE + 1))
    azimuth = state[ACTUATORS : ACTUATORS + thrusters].copy()
    return Seen(north, east, heading, surge, sway, yaw_rate, azimuth)


def drive(
    boat: Boat,
    controller: Controller,
    pose: tuple[float, float, float],
    seconds: float,
    dt: float = 0.1,
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    failed: Collection[str] = (),
    look: Callable[[Array], Seen] = truth,
    seed: int = 0,
) -> Array:
    """(T + 1, S) states of the boat, its own effects on, from a pose [m, m, rad] and velocity over ground.

    failed: thrusters that are dead from the start. look: from the state (S,) to what the controller sees.
    """
    params = parameters(boat)
    params["failure_time"][:, np.isin(boat.thruster_names, list(failed))] = 0.0
    state = initial_state(params, np.array([pose]), np.array([velocity]))
    seeds = np.array([seed], np.uint64)
    track = [state[0].copy()]
    for _ in range(round(seconds / dt)):
        commands = controller.act(look(state[0]), dt)
        step(state, params, tank(boat), commands[None], seeds, dt, substeps_of(dt))
        track.append(state[0].copy())
    return np.array(track)
