"""Thrust deduction from the speed that a set throttle reaches (thesis 7.3.5, eq. 7.3)."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.identification.estimate import BLOCK, Estimate
from swamp_rl.identification.identifiability import doubt
from swamp_rl.identification.motion import Motion
from swamp_rl.manoeuvres.captive import bollard_of_all, fastest, resistance_at

Array = NDArray[np.float64]

LEAST = 10.0  # s of steady straight running that make a speed
SETTLE = 30.0  # s after a change of throttle that are left out
TURNING = 0.08  # rad/s of yaw rate, root mean square, above which a stretch was no straight run
STEERING = 0.15  # rad, the same of the steering angle
SIDEWAYS = 0.2  # share of the thrust that may go sideways
SAME = 0.01  # throttle within which two are the same


class Point(NamedTuple):
    """One throttle [1]: speed [m/s] with its 95 % interval, seconds of it, and 1 - t [1] with its own."""

    throttle: float
    ahead: bool
    speed: float
    seconds: float
    factor: float
    low: float
    high: float


def stretches(motion: Motion) -> list[slice]:
    """Rows of one throttle and one way along the hull, settled and straight; small steering is let be."""
    found = []
    settle, least = (round(seconds / motion.step) for seconds in (SETTLE, LEAST))
    ends = np.cumsum((0, *motion.lengths))
    way = np.sign(motion.jets[:, 0])
    for a, b in pairwise(ends):
        changes = (np.abs(np.diff(motion.throttle[a:b])) > SAME) | (np.diff(way[a:b]) != 0)
        edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [b - a]]) + a
        for start, stop in pairwise(edges):
            part = slice(int(start) + settle, int(stop))
            if (
                stop - start - settle >= least
                and motion.throttle[part].mean() > SAME
                and straight(motion, part)
            ):
                found.append(part)
    return found


def straight(motion: Motion, part: slice) -> bool:
    """Whether the jets push along the hull and the boat keeps its course."""
    surge, sway, _ = np.sqrt(np.mean(motion.jets[part] ** 2, axis=0))
    steering, turning = (
        float(np.sqrt(np.mean(values**2))) for values in (motion.steering[part], motion.velocity[part, 2])
    )
    return bool(sway < SIDEWAYS * surge and steering < STEERING and turning < TURNING)


def deduction_points(motion: Motion, boat: Boat) -> list[Point]:
    """1 - t = R(U) / T_bollard for every steady straight stretch; empty where there is none.

    The interval is that of the mean speed, by Student's t from blocks of 5 s, carried through the resistance
    curve. A current along the course shifts every point: `paired` takes the mean of opposite directions.
    """
    from scipy.special import stdtrit

    found = []
    for part in stretches(motion):
        speed = motion.velocity[part, 0]
        blocks = np.array_split(speed, max(2, round(len(speed) * motion.step / BLOCK)))
        mean = float(speed.mean())
        deviation = float(np.std([block.mean() for block in blocks], ddof=1))
        error = float(stdtrit(len(blocks) - 1, 0.975)) * deviation / np.sqrt(len(blocks))
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


def point_doubt(point: Point, boat: Boat) -> str | None:
    """Why a stretch does not determine its 1 - t; None where it does."""
    most = fastest(boat)
    if (point.speed > 0.0) != point.ahead:
        return f"the boat goes {point.speed:+.3f} m/s against its jets"
    if abs(point.speed) > most:
        return f"the resistance is known up to {most:.4g} m/s"
    return doubt(Estimate(point.factor, point.low, point.high, "1"))


def paired(points: list[Point], boat: Boat) -> dict[float, float]:
    """1 - t [1] by throttle, from the mean speed over all directions, in which a steady current cancels."""
    levels = sorted({round(point.throttle, 2) for point in points})
    found = {}
    for level in levels:
        speeds = [abs(point.speed) for point in points if round(point.throttle, 2) == level]
        found[level] = resistance_at(boat, float(np.mean(speeds))) / bollard_of_all(boat, level)
    return found
