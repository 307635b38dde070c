"""Controllers and the compiled simulator in a closed loop."""

from collections.abc import Callable, Collection
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.state import ACTUATORS, NORTH, TIME, YAW_RATE
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]
Decide = Callable[[list[Array]], tuple[Array, bool]]
"""From the states (n, S) so far to commands (n, 2K) and whether the loop ends."""


class Seen(NamedTuple):
    """What a controller knows: time [s], pose [m, m, rad, not wrapped], velocity over ground [m/s, rad/s],
    azimuths (K,) [rad].
    """

    time: float
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


def seen_of(time: float, state: Array, channels: Array) -> Seen:
    """A boat of `state` (S,) as its sensors report pose and velocity (6,), with the true azimuths."""
    thrusters = (len(state) - ACTUATORS) // 2
    north, east, heading, surge, sway, yaw_rate = channels.tolist()
    azimuth = state[ACTUATORS : ACTUATORS + thrusters].copy()
    return Seen(time, north, east, heading, surge, sway, yaw_rate, azimuth)


def truth(state: Array) -> Seen:
    """The state (S,) itself, as a perfect navigator would see it."""
    return seen_of(float(state[TIME]), state, state[NORTH : YAW_RATE + 1])


def closed_loop(
    boat: Boat, params: NDArray[Any], state: Array, decide: Decide, seeds: NDArray[np.uint64], dt: float
) -> tuple[Array, Array]:
    """(n, T + 1, S) states and (n, T + 1, 2K) commands of n boats from `state` (n, S) until `decide` ends.

    Commands are held for dt [s] and act after each boat's `command_delay`. `state` is changed.
    """
    curves, substeps = tank(boat), substeps_of(dt, boat)
    delays = params["command_delay"] / dt
    late = np.flatnonzero(delays > 0.0)
    past = np.zeros((len(state), 3 + int(delays.max()), 2 * len(boat.thrusters)))
    states: list[Array] = [state.copy()]
    asked: list[Array] = []
    while True:
        commands, over = decide(states)
        tick = len(asked)
        asked.append(commands.copy())
        if over:
            return np.stack(states, axis=1), np.stack(asked, axis=1)
        past[:, tick % past.shape[1]] = commands
        arrived = commands.copy()
        for i in late:
            delayed_command(past[i], tick, delays[i], arrived[i])
        step(state, params, curves, arrived, seeds, dt, substeps)
        states.append(state.copy())


def drive(
    boat: Boat,
    controller: Controller,
    pose: tuple[float, float, float],
    seconds: float,
    dt: float = 0.1,
    failed: Collection[str] = (),
) -> Array:
    """(T + 1, S) states of the boat, its own effects on, from rest at a pose [m, m, rad].

    failed: thrusters that are dead from the start. The controller sees the true state.
    """
    params = parameters(boat)
    params["failure_time"][:, np.isin(boat.thruster_names, list(failed))] = 0.0
    state = initial_state(params, np.array([pose]))
    steps = round(seconds / dt)

    def decide(states: list[Array]) -> tuple[Array, bool]:
        if len(states) > steps:
            return np.zeros((1, 2 * len(boat.thrusters))), True
        return controller.act(truth(states[-1][0]), dt)[None], False

    return closed_loop(boat, params, state, decide, np.zeros(1, np.uint64), dt)[0][0]
