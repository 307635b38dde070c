"""What a recorder drives: a boat in real time, simulated or at a link."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.simulator.state import ACTUATORS

Array = NDArray[Any]
Levers = tuple[float, float]
"Throttle in [0, 1] and angle in [-1, 1], as the joypad's; the stern's angle is in quarter turns, [-2, 2]."
IDLE: Levers = (0.0, 0.0)
Weather = tuple[float, float, float, float]
"Wind north and east, where it comes from, then current north and east, where it goes [m/s]."


@dataclass(frozen=True)
class Instant:
    """The boat at one time; arrays are its own."""

    state: Array
    "(S,) as in `swamp_rl.simulator.state`"
    commands: Array
    "(2K,) azimuths [rad], then throttles [1]: in force until the next control step"
    passed: int
    "gates"
    levers: Levers = IDLE
    "that gave the commands"


class Craft(Protocol):
    """A boat under way in control steps, looked at in between; every `now` is the server's clock [s]."""

    boat: Boat
    course: Course
    simulated: bool
    "Whether wind and actuators are known, and a run can be sailed again."
    now: Instant
    "Where the present step began."
    observation: Array
    "(d,) there."

    @property
    def stern(self) -> tuple[str, ...]:
        """Thrusters that the levers do not drive."""

    @property
    def outcome(self) -> str | None:
        """How the run ended; None while it has not."""

    @property
    def trouble(self) -> str | None:
        """Why the boat cannot be driven now, as a sentence; None where it can."""

    def begin(self, seed: int) -> None:
        """Be ready for a run from the start of `seed`."""

    def start(self, now: float) -> None:
        """The run begins."""

    def heed(self, now: float, levers: Levers, stern: Levers = IDLE) -> None:
        """Obey the levers from now on. Called many times in every step."""

    def step_end(self, now: float) -> float | None:
        """When the present step of the run has ended [s]; None where it has not by `now`."""

    def go_on(self) -> tuple[Instant, Instant]:
        """Begin the next step; beginning and end of the one that has ended."""

    def at(self, now: float) -> Array:
        """(S,) the state now."""

    def weather(self, state: Array) -> Weather | None:
        """Wind and current in that state, None where they are unknown."""

    def about(self) -> dict[str, Any]:
        """Where the run comes from, for its entry in `dataset.yaml`."""

    def warm(self, seed: int) -> None:
        """Compile what would otherwise halt the first run, before `begin`."""


def actuators(state: Array) -> tuple[Array, Array]:
    """Azimuths (K,) [rad] and throttles (K,) [1] that the thrusters have reached."""
    azimuths, throttles = np.split(state[ACTUATORS:], 2)
    return azimuths, throttles
