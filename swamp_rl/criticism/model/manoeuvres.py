"""Short open-loop manoeuvres, as commands, of which one is proposed to separate hypotheses."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.options import options
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]


def manoeuvres(boat: Boat, dt: float, seconds: float | None = None) -> dict[str, Array]:
    """Commands (T, 2K) by name, for the boat's thrusters within their azimuth limits."""
    seconds = options().trial_seconds if seconds is None else seconds
    time = np.arange(round(seconds / dt)) * dt
    record = parameters(boat)[0]
    low, high = record["azimuth_min"], record["azimuth_max"]
    side = np.sign([thruster.x for thruster in boat.thrusters])
    starboard = np.sign([thruster.y for thruster in boat.thrusters])
    count = len(boat.thrusters)
    square_wave = np.where(np.sin(2 * math.pi * time / options().zig_zag_period) >= 0, 1.0, -1.0)

    def of(angles: Array, throttles: Array) -> Array:
        rows = np.zeros((len(time), 2 * count))
        rows[:, :count] = np.clip(angles, low, high)
        rows[:, count:] = throttles
        return rows

    ones, zeros = np.ones(count), np.zeros(count)
    found = {
        "straight ahead, 60 %": of(zeros, 0.6 * ones),
        "straight ahead, 100 %": of(zeros, ones),
        "straight ahead, then stopped": of(zeros, np.outer(time < seconds / 2, ones)),
        "turning circle to starboard, 60 %": of(0.5 * side, 0.6 * ones),
        "turning circle to port, 60 %": of(-0.5 * side, 0.6 * ones),
        "zig-zag, 80 %": of(np.outer(square_wave, 0.5 * side), 0.8 * ones),
        "spin": of(side * math.pi / 2, 0.6 * ones),
        "astern": of(math.pi * ones, 0.6 * ones),
        "sideways": of(math.pi / 2 * ones, 0.6 * ones),
        "differential thrust": of(zeros, 0.5 + 0.3 * np.outer(square_wave, -starboard)),
        "adrift": of(zeros, np.outer(time < 10.0, 0.8 * ones)),
    }
    for k, thruster in enumerate(boat.thrusters):
        found[f"{thruster.name} alone, 80 %"] = of(zeros, 0.8 * (np.arange(count) == k))
    return {
        name: rows for name, rows in found.items() if np.ptp(rows[:, count:]) > 0 or rows[:, count:].any()
    }
