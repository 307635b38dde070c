"""One boat in real time: it sails in whole control steps, and is looked at in between."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.physics.motion import current_at
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, NORTH, SURGE, SWAY, TIME, YAW_RATE
from swamp_rl.simulator.step import wind_now

Array = NDArray[Any]
Levers = tuple[float, float]
"Throttle in [0, 1] and angle in [-1, 1], as the joypad's; the stern's angle is in quarter turns, [-2, 2]."
IDLE: Levers = (0.0, 0.0)


class Fleet(Protocol):
    """What is asked of the boats behind the environment; there is one."""

    boat: Boat
    course: Course
    step: float
    boats: Array
    "(1,) records with at least `state` (S,), `command` (2K,), `passed` and `gust_seed`"
    params: Array
    "(1,) parameter records"

    def drawn(self, i: int) -> dict[str, Any]:
        """`effects` and `gust_seed` of the episode."""

    def hold(self, thrusters: Sequence[str], azimuth: float, throttle: float) -> None:
        """Command thrusters that the levers do not drive."""


class Env(Protocol):
    """What is asked of the environment: a `gymnasium.Env` whose whole state is in `fleet.boats`."""

    @property
    def fleet(self) -> Fleet:
        """What sails."""

    def reset(self, *, seed: int | None = None) -> tuple[Array, dict[str, Any]]:
        """Observation (d,) at the start of the episode of that seed."""

    def step(self, action: Array) -> tuple[Array, Any, bool, bool, dict[str, Any]]:
        """Observation (d,), reward, terminated, truncated, info with `outcome` at the end."""


MakeEnv = Callable[[str | None, tuple[str, ...]], Env]
"""Builds the environment of a level of disturbance (None is none) that is observed by the given names."""


@dataclass(frozen=True)
class Instant:
    """The boat at one time; arrays are its own."""

    state: Array
    "(S,) as in `swamp_rl.simulator.state`"
    commands: Array
    "(2K,) azimuths [rad], then throttles [1]: in force until the next control step"
    passed: int
    "gates"


class Afloat:
    """A boat between two control steps: where the present one began, and where it will end.

    A step's levers may be changed until its end: `foresee` sails the step anew from its beginning. So what
    a person does counts from the beginning of the control step it falls into, shows at once, and a run is
    still one command for each step.
    """

    def __init__(self, env: Env) -> None:
        self.env, self.fleet = env, env.fleet
        joypad = self.fleet.boat.joypad.thrusters
        self.stern = tuple(name for name in self.fleet.boat.thruster_names if name not in joypad)
        self.step = self.fleet.step

    def begin(self, seed: int) -> None:
        """Put the boat at the start of the episode of `seed`."""
        self.seed = seed
        self.observation, _ = self.env.reset(seed=seed)
        self.drawn = self.fleet.drawn(0)
        self.outcome: str | None = None
        self._ahead_outcome: str | None = None
        self._records = self.fleet.boats.copy()
        self.now = self.ahead = self._instant()

    def foresee(self, levers: Levers, stern: Levers = IDLE) -> None:
        """Sail the present step with these levers, as far as its end and not into the next.

        stern: throttle, and azimuth in quarter turns, of the thrusters that the levers do not drive.
        """
        if self.outcome is not None:
            return
        self.fleet.boats[:] = self._records
        self.fleet.hold(self.stern, 0.5 * np.pi * stern[1], stern[0])
        self._seen, _, terminated, truncated, info = self.env.step(np.array(levers))
        self._ahead_outcome = str(info["outcome"]) if terminated or truncated else None
        self.ahead = self._instant()

    def go_on(self) -> tuple[Instant, Instant]:
        """End the present step as it was foreseen last and begin the next; its beginning and its end.

        The first of the two has the commands that were in force between them.
        """
        before, after = self.now, self.ahead
        self.observation, self.outcome = self._seen, self._ahead_outcome
        self._records, self.now = self.fleet.boats.copy(), after
        return Instant(before.state, after.commands, before.passed), after

    def at(self, share: float) -> Array:
        """(S,) the state after that share in [0, 1] of the step, by cubics through its two ends."""
        start, end = self.now.state, self.ahead.state
        state = start + share * (end - start)
        for place, slopes in ((NORTH, over_ground), (EAST, over_ground), (HEADING, turning)):
            first, last = slopes(start)[place], slopes(end)[place]
            state[place] = _cubic(start[place], end[place], self.step * first, self.step * last, share)
        return state

    def weather(self, state: Array) -> tuple[float, float, float, float]:
        """Wind north and east, where it comes from, then current north and east, where it goes [m/s]."""
        p = self.fleet.params[0]
        return (*wind_now(state, p), *current_at(state[TIME], p))

    def _instant(self) -> Instant:
        record = self.fleet.boats[0]
        return Instant(record["state"].copy(), record["command"].copy(), int(record["passed"]))


def over_ground(state: Array) -> dict[int, float]:
    """Velocity north and east [m/s], by place in the state (S,)."""
    cos, sin = np.cos(state[HEADING]), np.sin(state[HEADING])
    return {
        NORTH: float(state[SURGE] * cos - state[SWAY] * sin),
        EAST: float(state[SURGE] * sin + state[SWAY] * cos),
    }


def turning(state: Array) -> dict[int, float]:
    """Yaw rate [rad/s], by the place of what it changes."""
    return {HEADING: float(state[YAW_RATE])}


def _cubic(start: float, end: float, slope_start: float, slope_end: float, s: float) -> float:
    """Hermite's cubic over s in [0, 1]."""
    rise = end - start
    square = 3.0 * rise - 2.0 * slope_start - slope_end
    return start + s * (slope_start + s * (square + s * (slope_start + slope_end - 2.0 * rise)))


def actuators(state: Array) -> tuple[Array, Array]:
    """Azimuths (K,) [rad] and throttles (K,) [1] that the thrusters have reached."""
    azimuths, throttles = np.split(state[ACTUATORS:], 2)
    return azimuths, throttles
