"""Thrust deduction from the speed that a set throttle reaches (thesis 7.3.5, eq. 7.3)."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.identification.estimate import BLOCK
from swamp_rl.identification.motion import Motion
from swamp_rl.physics.resistance import surge_resistance, towing
from swamp_rl.physics.thrusters import bollard_thrust
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

LEAST = 10.0  # s of steady straight running that make a speed
SETTLE = 30.0  # s after a change of throttle that are left out
TURNING = 0.1  # rad/s of mean yaw rate above which a stretch was no straight run


class Point(NamedTuple):
    """One throttle [1]: speed [m/s] with its 95 % interval, seconds of it, and 1 - t [1] with its own."""

    throttle: float
    ahead: bool
    speed: float
    seconds: float
    factor: float
    low: float
    high: float


def resistance_at(boat: Boat, speed: float) -> float:
    """Resistance [N] of the towing tank at a speed [m/s] through the water."""
    record, curves = parameters(boat)[0], tank(boat)
    return float(-surge_resistance(abs(speed), 0.0, record, curves, towing(record, curves)))


def bollard_of_all(boat: Boat, throttle: float) -> float:
    """Thrust [N] at rest of all jets at one throttle [1], without deduction."""
    record = parameters(boat)[0]
    return float(sum(bollard_thrust(throttle, k, record) for k in range(len(boat.thrusters))))


def stretches(motion: Motion) -> list[slice]:
    """Rows of constant throttle and azimuth with the jets along the hull, settled and straight."""
    found = []
    settle, least = (round(seconds / motion.step) for seconds in (SETTLE, LEAST))
    ends = np.cumsum((0, *motion.lengths))
    for a, b in pairwise(ends):
        same = np.all(np.abs(np.diff(motion.jets[a:b], axis=0)) < 1e-6, axis=1)
        edges = np.concatenate([[0], np.flatnonzero(~same) + 1, [b - a]]) + a
        for start, stop in pairwise(edges):
            part = slice(int(start) + settle, int(stop))
            if stop - start - settle < least or motion.throttle[part].mean() < 0.05:
                continue
            sideways = np.abs(motion.jets[part, 1:]).max() > 0.05 * np.abs(motion.jets[part, 0]).max()
            if not sideways and abs(motion.velocity[part, 2].mean()) < TURNING:
                found.append(part)
    return found


def deduction_points(motion: Motion, boat: Boat) -> list[Point]:
    """1 - t = R(U) / T_bollard for every steady straight stretch; empty where there is none.

    The interval is that of the mean speed, from blocks of 5 s, carried through the resistance curve. A
    current along the course shifts every point: `paired` takes the mean of opposite directions.
    """
    found = []
    for part in stretches(motion):
        speed = motion.velocity[part, 0]
        blocks = np.array_split(speed, max(2, round(len(speed) * motion.step / BLOCK)))
        mean = float(speed.mean())
        error = 2.0 * float(np.std([block.mean() for block in blocks], ddof=1)) / np.sqrt(len(blocks))
        throttle = float(motion.throttle[part].mean())
        bollard = bollard_of_all(boat, throttle)
        size = abs(mean)
        low, middle, high = (
            resistance_at(boat, max(value, 0.0)) / bollard for value in (size - error, size, size + error)
        )
        seconds = len(speed) * motion.step
        ahead = bool(motion.jets[part, 0].mean() > 0.0)
        found.append(Point(throttle, ahead, mean, seconds, middle, low, high))
    return found


def paired(points: list[Point], boat: Boat) -> dict[float, float]:
    """1 - t [1] by throttle, from the mean speed over all directions, in which a steady current cancels."""
    levels = sorted({round(point.throttle, 2) for point in points})
    found = {}
    for level in levels:
        speeds = [abs(point.speed) for point in points if round(point.throttle, 2) == level]
        found[level] = resistance_at(boat, float(np.mean(speeds))) / bollard_of_all(boat, level)
    return found
