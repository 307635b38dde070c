"""Simulated runs of known truth and noise, of the kinds that the papers identify from."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.runs import Run
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.sensors.observe import CHANNELS, add_noise, observe
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]

STEPS = (0.4, 0.8, 0.6, 1.0, 0.3, 0.0)  # throttles that an elementary motion goes through
HELD = 20.0  # s of each
STRAIGHT = 60.0  # s of a straight run at one throttle


def record_run(
    boat: Boat, commands: Array, dt: float, noise: Array, rng: np.random.Generator, name: str = "run"
) -> Run:
    """A run of `boat` with its effects, from rest, under commands (T, 2K); noise (6,): of each channel.

    The actuators begin where the first row wants them.
    """
    params = parameters(boat)
    start = initial_state(params, np.zeros((1, 3)))
    start[:, ACTUATORS:] = commands[0]
    seeds = rng.integers(2**63, size=1).astype(np.uint64)
    track = simulate(params, tank(boat), start, commands[None], seeds, dt, substeps_of(dt, boat))[:, :-1]
    measured = add_noise(observe(track, params, dt)[0], noise, rng)
    columns = {"time": np.arange(len(commands)) * dt} | dict(zip(CHANNELS, measured.T, strict=True))
    columns["heading"] = wrapped(columns["heading"])
    for k, thruster in enumerate(boat.thrusters):
        angle, level = thruster.command_columns
        if angle is not None:
            columns[angle] = commands[:, k]
            columns[f"applied_{angle}"] = track[0, :, ACTUATORS + k]
        columns[level] = commands[:, len(boat.thrusters) + k]
    return Run(name, columns)


def _rows(boat: Boat, angle: Array, throttle: Array) -> Array:
    """(T, 2K) commands: `angle` (T,) at the bow and its opposite at the stern, one throttle (T,) for all."""
    bow = np.sign([thruster.x for thruster in boat.thrusters])
    return np.hstack([np.outer(angle, bow), np.outer(throttle, np.ones(len(bow)))])


def zigzag(boat: Boat, dt: float, angle: float, throttle: float = 0.6, seconds: float = 120.0) -> Array:
    """(T, 2K) azimuths [rad] over from side to side every 8 s, bow and stern opposed (002, section 3.2)."""
    time = np.arange(round(seconds / dt)) * dt
    return _rows(boat, np.where((time // 8.0) % 2 == 0, angle, -angle), np.full(len(time), throttle))


def ahead_by_steps(boat: Boat, dt: float) -> Array:
    """(T, 2K) straight ahead, the throttle stepping through `STEPS`."""
    throttle = np.repeat(STEPS, round(HELD / dt))
    return _rows(boat, np.zeros(len(throttle)), throttle)


def on_the_spot(boat: Boat, dt: float) -> Array:
    """(T, 2K) turning on the spot, to either side in turn, the throttle stepping through `STEPS`."""
    throttle = np.repeat(STEPS, round(HELD / dt))
    side = np.repeat([1.0, -1.0] * (len(STEPS) // 2), round(HELD / dt))
    return _rows(boat, 0.5 * math.pi * side, throttle)


def straights(boat: Boat, dt: float, throttles: Sequence[float], ahead: bool) -> Array:
    """(T, 2K) straight runs at each throttle in turn, ahead or astern (thesis 7.3.5)."""
    throttle = np.repeat(throttles, round(STRAIGHT / dt))
    rows = _rows(boat, np.zeros(len(throttle)), throttle)
    rows[:, : len(boat.thrusters)] = 0.0 if ahead else math.pi
    return rows
