"""Runs of trials whose figures are known in closed form, with the commands of an azimuth boat."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swamp_rl.runs import Run, RunMeta

Array = NDArray[np.float64]


def commanded(angle: Array, throttle: float = 0.6) -> dict[str, Array]:
    """Columns of SWAMP's commands: bow + angle, stern - angle."""
    columns = {}
    for name, side in (("bs", 1.0), ("bp", 1.0), ("ss", -1.0), ("sp", -1.0)):
        columns[f"azimuth_{name}"] = side * angle
        columns[f"throttle_{name}"] = np.full(len(angle), throttle)
    return columns


def run_of_headings(
    time: Array,
    heading: Array,
    course: Array,
    speed: float,
    angle: Array,
    current: tuple[float, float] = (0.0, 0.0),
    name: str = "made",
    **meta: object,
) -> Run:
    """A run that moves at `speed` along `course` [rad] through water that moves by `current` north, east."""
    steps, middle = np.diff(time), 0.5 * (course[1:] + course[:-1])
    half = 0.5 * np.abs(np.diff(course))
    chord = speed * steps * np.sinc(half / math.pi)  # exact along an arc
    north = np.concatenate([[0.0], np.cumsum(chord * np.cos(middle))]) + current[0] * time
    east = np.concatenate([[0.0], np.cumsum(chord * np.sin(middle))]) + current[1] * time
    columns = {
        "time": time,
        "north": north,
        "east": east,
        "heading": math.pi - np.mod(math.pi - heading, 2.0 * math.pi),
    }
    return Run(name, columns | commanded(angle), RunMeta.model_validate(meta))


def circle_run(
    diameter: float,
    drift_angle: float,
    side: float = 1.0,
    turns: float = 3.0,
    speed: float = 0.8,
    current: tuple[float, float] = (0.0, 0.0),
    heading: float = 0.3,
) -> Run:
    """Five seconds straight at `speed`, then at once an exact circle, the bow in by the drift angle."""
    rate, straight = 2.0 * speed / diameter, 5.0
    time = np.arange(round((straight + turns * 2.0 * math.pi / rate) * 10) + 2) * 0.1
    turned = np.maximum(time - straight, 0.0) * rate
    over = time > straight - 0.05
    headings = heading + side * turned
    courses = headings - side * np.where(over, drift_angle, 0.0)
    return run_of_headings(time, headings, courses, speed, side * np.where(over, 0.5, 0.0), current)


def nomoto_zig_zag(gain: float, lag: float, angle: float, reverse_at: float, executes: int = 6) -> Run:
    """A zig-zag of T r' + r = K delta, integrated exactly between the executes; speed 1 m/s."""
    step, state = 0.05, [0.0, 0.0]
    times, headings, angles = [], [], []
    side, count, time = 1.0, 0, -5.0
    while count <= executes:
        if count == 0 and time >= 0.0:
            count = 1
        elif count and side * state[0] >= reverse_at:
            side, count = -side, count + 1
        ordered = side * angle if 0 < count <= executes else (0.0 if count == 0 else -side * angle)
        times.append(time)
        headings.append(state[0])
        angles.append(ordered)
        steady, keep = gain * ordered, math.exp(-step / lag)
        state[0] += steady * step + (state[1] - steady) * lag * (1.0 - keep)
        state[1] = steady + (state[1] - steady) * keep
        time += step
    heading = np.array(headings)
    return run_of_headings(np.array(times), heading, heading, 1.0, np.array(angles))


def nomoto_first_overshoot(gain: float, lag: float, angle: float, reverse_at: float) -> float:
    """The first overshoot [rad] of that model, in closed form but for the moment of the second execute."""
    pull = gain * angle

    def heading(time: float) -> float:
        return pull * (time - lag * (1.0 - math.exp(-time / lag)))

    rate = pull * (1.0 - math.exp(-root(lambda time: heading(time) - reverse_at) / lag))
    return lag * rate - pull * lag * math.log((rate + pull) / pull)


def root(function: Callable[[float], float], low: float = 0.0, high: float = 1000.0) -> float:
    """Where an increasing function passes zero."""
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return low
