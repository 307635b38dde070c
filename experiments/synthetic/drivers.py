"""How the boat of a blind case is driven: trials of all four thrusters, gate runs with the bow's alone."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.observation import OBSERVATION, look

from swamp_rl.course import gate_table, load_course
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.simulator.state import EAST, HEADING, NORTH

Array = NDArray[np.float64]
Rng = np.random.Generator
Driver = Callable[
    [float, Array], Array
]  # time [s], state (S,) -> azimuths [rad], throttles [1] of bs bp ss sp


def steered(angle: float, throttle: float) -> Array:
    """Bow to one side, stern to the other."""
    return np.array([angle, angle, -angle, -angle, *(throttle,) * 4])


def straight(throttle: float) -> Driver:
    """Ahead at one throttle."""
    return lambda time, state: steered(0.0, throttle)


def circles(rng: Rng) -> Driver:
    """A turning circle, then one the other way and tighter."""
    angle, throttle = rng.choice([-1, 1]) * rng.uniform(0.2, 0.7), rng.uniform(0.5, 0.9)

    def drive(time: float, state: Array) -> Array:
        return steered(0.0 if time < 10 else angle if time < 45 else -1.4 * angle, throttle)

    return drive


def zigzag(rng: Rng) -> Driver:
    """Steering over whenever the heading has gone as far as the azimuth was turned."""
    angle, throttle = rng.uniform(0.2, 0.6), rng.uniform(0.4, 0.9)
    side, course = [1.0], [math.nan]

    def drive(time: float, state: Array) -> Array:
        if math.isnan(course[0]):
            course[0] = state[HEADING]
        if side[0] * (state[HEADING] - course[0]) > angle:
            side[0] = -side[0]
        return steered(side[0] * angle, throttle)

    return drive


def spiral(rng: Rng) -> Driver:
    """The azimuth goes from one side to the other in steps."""
    throttle, first = rng.uniform(0.5, 0.9), rng.choice([-1, 1]) * rng.uniform(0.4, 0.8)
    return lambda time, state: steered(first * (1.0 - math.floor(time / 10) / 3.5), throttle)


def ahead_and_astern(rng: Rng) -> Driver:
    """Ahead at two throttles, stopping with the jets turned round, astern, adrift."""
    low, high, skew = rng.uniform(0.3, 0.5), rng.uniform(0.7, 1.0), rng.uniform(-0.1, 0.1)

    def drive(time: float, state: Array) -> Array:
        if time < 20:
            return steered(skew, low)
        if time < 38:
            return steered(-skew, high)
        angle = math.pi - skew if time < 62 else 0.0
        throttle = high if time < 46 else low if time < 62 else 0.0 if time < 70 else high
        return np.array([*(angle,) * 4, *(throttle,) * 4])

    return drive


def random_steps(rng: Rng) -> Driver:
    """Every thruster for itself, changed after a few seconds."""
    azimuths, throttles = rng.uniform(-math.pi, math.pi, (200, 4)), rng.uniform(0.0, 1.0, (200, 4))
    changes = np.cumsum(rng.uniform(1.5, 6.0, 200))
    return lambda time, state: np.concatenate(
        [azimuths[np.searchsorted(changes, time)], throttles[np.searchsorted(changes, time)]]
    )


RICH = (circles, zigzag, spiral, ahead_and_astern, random_steps)


def gate_run(rng: Rng) -> tuple[Driver, Array]:
    """A scripted person through the gates and round again, stern thrusters off; and the start pose."""
    course = load_course("camogli")
    gates = gate_table(course)
    pilot = ScriptedPilot(int(rng.integers(2**31)))
    pilot.reset(1)
    places = [OBSERVATION.index(name) for name in pilot.senses]
    seen, passed = np.zeros(len(OBSERVATION)), [0]

    def drive(time: float, state: Array) -> Array:
        gate = gates[passed[0]]
        if math.hypot(gate[0] - state[NORTH], gate[1] - state[EAST]) < 1.0:
            passed[0] = (passed[0] + 1) % len(gates)
        look((state[NORTH], state[EAST], state[HEADING]), state, passed[0], gates, seen)
        throttle, angle = pilot.act(seen[None, places])[0]
        turned = angle * math.pi / 2
        return np.array([turned, turned, 0.0, 0.0, throttle, throttle, 0.0, 0.0])

    pose, spread = course.start.pose, course.start.spread
    offset = rng.uniform(-1, 1, 3) * [spread.north, spread.east, spread.heading]
    return drive, np.array([pose.north, pose.east, pose.heading]) + offset
