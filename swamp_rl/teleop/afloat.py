"""One simulated boat in real time: it sails in whole control steps, and is looked at in between."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from swamp_rl.angles import turned
from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.physics.motion import current_at
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, TIME, YAW_RATE
from swamp_rl.simulator.step import step as sail
from swamp_rl.simulator.step import wind_now
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.teleop.craft import IDLE, Array, Instant, Levers, Weather
from swamp_rl.teleop.rows import initial_state

BEHIND = 0.5
"How far [s] the boat may lag behind the clock; what a stalled machine lost beyond is not made up for."


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


class Afloat:
    """A simulated boat between two control steps: where the present one began, and where it will end.

    A step's levers may be changed until its end: the step is then sailed anew from its beginning. So what
    a person does counts from the beginning of the control step it falls into, shows at once, and a run is
    still one command for each step.
    """

    simulated = True
    trouble: str | None = None
    "Nothing keeps a simulated boat from being driven."

    def __init__(self, env: Env) -> None:
        self.env, self._fleet = env, env.fleet
        self.boat, self.course, self.step = env.fleet.boat, env.fleet.course, env.fleet.step
        self.stern = self.boat.beside_joypad

    def begin(self, seed: int) -> None:
        """Put the boat at the start of the episode of `seed`; it waits there."""
        self._seed = seed
        self._began: float | None = None
        self.observation, _ = self.env.reset(seed=seed)
        self.drawn = self._fleet.drawn(0)
        self.outcome: str | None = None
        self._ahead_outcome: str | None = None
        self._records = self._fleet.boats.copy()
        self._foreseen: tuple[Levers, Levers] | None = None
        self.now = self.ahead = self._instant(IDLE)
        self._start = self.now.state

    def start(self, now: float) -> None:
        """The run begins at the clock's time `now` [s]."""
        self._began = now

    def step_end(self, now: float) -> float | None:
        """When the present step has ended [s]; None where it has not by `now`."""
        assert self._began is not None
        self._began = max(self._began, now - BEHIND)
        end = self._began + self.step
        return end if now >= end else None

    def heed(self, now: float, levers: Levers, stern: Levers = IDLE) -> None:
        """Sail the present step with these levers, as far as its end and not into the next.

        stern: throttle, and azimuth in quarter turns, of the thrusters that the levers do not drive.
        """
        if self._began is None or self.outcome is not None or (levers, stern) == self._foreseen:
            return
        self._foreseen = levers, stern
        self._fleet.boats[:] = self._records
        self._fleet.hold(self.stern, 0.5 * np.pi * stern[1], stern[0])
        self._seen, _, terminated, truncated, info = self.env.step(np.array(levers))
        self._ahead_outcome = str(info["outcome"]) if terminated or truncated else None
        self.ahead = self._instant(levers)

    def go_on(self) -> tuple[Instant, Instant]:
        """End the present step as it was foreseen last and begin the next; its beginning and its end.

        Both have the levers and commands that were in force between them.
        """
        assert self._began is not None
        before, after = self.now, self.ahead
        self.observation, self.outcome = self._seen, self._ahead_outcome
        self._records, self.now = self._fleet.boats.copy(), after
        self._began, self._foreseen = self._began + self.step, None
        return replace(after, state=before.state, passed=before.passed), after

    def at(self, now: float) -> Array:
        """(S,) the state at the clock's time [s], by cubics through the two ends of the present step."""
        if self._began is None or self.outcome is not None:
            return self.now.state
        return self._within(min(max((now - self._began) / self.step, 0.0), 1.0))

    def weather(self, state: Array) -> Weather:
        """Wind and current in a state (S,)."""
        p = self._fleet.params[0]
        return (*wind_now(state, p), *current_at(state[TIME], p))

    def about(self) -> dict[str, Any]:
        """All that it takes to sail the run again."""
        return {
            "seed": self._seed,
            "initial_state": initial_state(self.boat, self._start),
            "disturbances": self.drawn["effects"],
            **{name: value for name, value in self.drawn.items() if name != "effects"},
        }

    def warm(self, seed: int) -> None:
        """Compile what would otherwise halt the first run and the first replay, which takes seconds once."""
        self.begin(seed)
        self.start(0.0)
        self.heed(0.0, IDLE)
        self.weather(self.at(0.05))
        state, commands = self.now.state[None].copy(), self.now.commands[None]
        gusts = np.zeros(1, np.uint64)
        sail(state, parameters(self.boat), tank(self.boat), commands, gusts, 0.1, substeps_of(0.1, self.boat))
        self.begin(seed)

    def _within(self, share: float) -> Array:
        start, end = self.now.state, self.ahead.state
        state = start + share * (end - start)
        for place, slopes in ((NORTH, over_ground), (EAST, over_ground), (HEADING, turning)):
            first, last = slopes(start)[place], slopes(end)[place]
            state[place] = _cubic(start[place], end[place], self.step * first, self.step * last, share)
        return state

    def _instant(self, levers: Levers) -> Instant:
        record = self._fleet.boats[0]
        return Instant(record["state"].copy(), record["command"].copy(), int(record["passed"]), levers)


def over_ground(state: Array) -> dict[int, float]:
    """Velocity north and east [m/s], by place in the state (S,)."""
    north, east = turned(state[SURGE], state[SWAY], state[HEADING])
    return {NORTH: float(north), EAST: float(east)}


def turning(state: Array) -> dict[int, float]:
    """Yaw rate [rad/s], by the place of what it changes."""
    return {HEADING: float(state[YAW_RATE])}


def _cubic(start: float, end: float, slope_start: float, slope_end: float, s: float) -> float:
    """Hermite's cubic over s in [0, 1]."""
    rise = end - start
    square = 3.0 * rise - 2.0 * slope_start - slope_end
    return start + s * (slope_start + s * (square + s * (slope_start + slope_end - 2.0 * rise)))
