"""A simulated boat navigated by a filter: how far off it is, and whether it knows how far."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.navigation.filter import Navigator
from swamp_rl.navigation.sensors import Sensors, due
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.state import ACTUATORS, SURGE, YAW_RATE
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]
Commands = Callable[[float, Navigator, Array], Array]


@dataclass(frozen=True)
class Navigated:
    """T steps: time (T,), true states (T, S), estimates (T, 8); nees (T,) of pose and velocity (six numbers).

    nis_gps, nis_ahrs: innovations squared of every reading (two numbers each).
    """

    time: Array
    truth: Array
    estimate: Array
    nees: Array
    nis_gps: Array
    nis_ahrs: Array

    @property
    def position_error(self) -> Array:
        """(T,) m."""
        return np.hypot(*(self.estimate[:, :2] - self.truth[:, :2]).T)


def navigate(
    boat: Boat,
    navigator: Navigator,
    sensors: Sensors,
    commands: Commands,
    seconds: float,
    rng: np.random.Generator,
    dt: float = 0.1,
    lost: tuple[float, float] = (np.inf, np.inf),
    walk: Array | None = None,
    pose: Array | None = None,
    velocity: Array | None = None,
) -> Navigated:
    """Drive `boat`, effects on, by commands(time, navigator, azimuths) (2K,), while the navigator looks on.

    lost: from when to when [s] the GPS is silent; walk: (8,) random walk [unit/sqrt(s)] on the true
    velocities and current, which makes the filter's own assumptions true; pose, velocity: (3,) at the start.
    """
    params = parameters(boat)
    start = np.zeros(3) if pose is None else pose
    state = initial_state(params, start[None], None if velocity is None else velocity[None])
    K, curves, substeps = len(boat.thrusters), tank(boat), substeps_of(dt, boat)
    kept: dict[str, list[Any]] = {name: [] for name in ("time", "truth", "estimate", "nees", "gps", "ahrs")}
    for number in range(round(seconds / dt)):
        time = (number + 1) * dt
        command = commands(time - dt, navigator, state[0, ACTUATORS : ACTUATORS + K])
        gusts = rng.integers(2**63, size=1).astype(np.uint64)
        step(state, params, curves, command[None], gusts, dt, substeps)
        if walk is not None:
            _wander(state[0], params, np.sqrt(dt) * walk * rng.standard_normal(8))
        navigator.predict(command, dt)
        if due(sensors.ahrs_interval, time, dt):
            kept["ahrs"].append(navigator.update(sensors.ahrs(state[0], rng)).squared)
        if due(sensors.gps_interval, time, dt) and not lost[0] <= time < lost[1]:
            kept["gps"].append(navigator.update(sensors.gps(state[0], rng)).squared)
        kept["time"].append(time)
        kept["truth"].append(state[0].copy())
        kept["estimate"].append(navigator.x.copy())
        kept["nees"].append(navigator.error_squared(state[0, :6]))
    return Navigated(*(np.array(values) for values in kept.values()))


def _wander(state: Array, params: NDArray[Any], by: Array) -> None:
    state[SURGE : YAW_RATE + 1] += by[3:6]
    params["current_north"] += by[6]
    params["current_east"] += by[7]
