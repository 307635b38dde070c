"""A vehicle at a link in real time: levers go out as commands, its telemetry comes in as a run's steps."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.link.helm import HOLD, LEAD, PERIOD, SETTLE, Latest, Link, send_period, stop
from swamp_rl.link.sensor_line import CAMOGLI
from swamp_rl.link.socket_link import ASK_AGAIN, PATIENCE
from swamp_rl.runs.local_frame import Place
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, NORTH, TIME, YAW_RATE, state_size
from swamp_rl.teleop.afloat import over_ground, turning
from swamp_rl.teleop.craft import IDLE, Array, Instant, Levers

LINK_LOST = "link_lost"
"""Outcome of a run in which no telemetry came, or no command went out, for HOLD."""
AT_ONCE = 100
"""Packets that are taken before the levers are obeyed again."""
EVEN = 0.01
"""Share of a period by which a sample may miss a row's time and still count as that row's."""


class OnCourse(Protocol):
    """The course and the levers of the vehicle, see `swamp_rl.envs.aboard.Measured`."""

    boat: Boat
    course: Course
    stern: tuple[str, ...]

    @property
    def outcome(self) -> str | None:
        """How the course ended; None while it has not."""

    @property
    def passed(self) -> int:
        """Gates so far."""

    def begin(self) -> None:
        """Be at the beginning of the course."""

    def move(self, time: float, senses: Array) -> None:
        """Take the motion (6,) at `time` [s]."""

    def commands(self, levers: Levers, stern: Levers = IDLE) -> Array:
        """Commands (2K,) of the levers."""


@dataclass(frozen=True)
class _Step:
    """Of a run: the motion (6,) at its end, the levers and commands (2K,) that were in force in it."""

    motion: Array
    levers: Levers
    commands: Array


class Linked:
    """A vehicle that answers at a link, as `swamp_rl.teleop.craft.Craft` says.

    Commands go out in the periods of `swamp_rl.link.helm`, whether a run is under way or not: so a person can
    bring the vehicle back. A run's rows are a period apart in the vehicle's time, from the sample on which
    the first thrust was sent; where no sample is at a row's time, the motion is interpolated.
    """

    simulated = False
    observation: Array = np.zeros(2)
    "Of no pilot."

    def __init__(self, link: Link, course: OnCourse, address: str, origin: Place = CAMOGLI) -> None:
        """address: what the runs' entries call the vehicle; origin: of north and east [degrees]."""
        self._link, self._course, self._address = link, course, address
        self.boat, self.course, self.stern = course.boat, course.course, course.stern
        self._latest = Latest(origin)
        self._started: float | None = None
        "When the first period began; None where nothing is sent, for lack of telemetry."
        self._period, self._asked = 0, -math.inf
        self._used: int | None = None
        self._motion = np.zeros(6)
        self._silent = True
        self._in_force = (IDLE, self._course.commands(IDLE))
        self._sent: list[tuple[Levers, Array]] = []
        self.begin()

    def begin(self, seed: int = 0) -> None:
        """Be ready for a run from where the vehicle is; there is nothing that a seed could draw."""
        self._course.begin()
        self._under_way, self._first = False, -1
        self._steps: deque[_Step] = deque()
        self._rows = self._interpolated = 0
        self._cut = False
        self.now = self._instant(0.0, self._motion, self._in_force)

    @property
    def outcome(self) -> str | None:
        """How the course ended; None while it has not."""
        return self._course.outcome or (LINK_LOST if self._cut and not self._steps else None)

    @property
    def trouble(self) -> str | None:
        """Why the levers are not obeyed."""
        if self._silent:
            return f"No telemetry from {self._address}: the pumps are stopped."
        return "The motors are being switched on." if self._period < SETTLE else None

    def start(self, now: float) -> None:
        """The run begins with the next commands."""
        self._under_way = True

    def heed(self, now: float, levers: Levers, stern: Levers = IDLE) -> None:
        """Take the telemetry that has come, and send the levers' commands where a period has begun."""
        self._hear(now)
        age = now - self._latest.came
        self._silent = age > HOLD
        self._cut |= self._under_way and self._silent
        if self._started is None or age > PATIENCE:
            self._wait(now)
        elif (late := self._late(now)) >= 0.0:
            self._send(levers, stern)
            self._period += 1 + math.floor(late / PERIOD)

    def step_end(self, now: float) -> float | None:
        """`now` where telemetry of a whole step has come."""
        self._hear(now)
        return now if self._steps else None

    def go_on(self) -> tuple[Instant, Instant]:
        """Take the earliest step that has not been taken; its beginning and its end."""
        step = self._steps.popleft()
        if self._rows == 0:
            self._course.move(0.0, self._begun)
            self.now = self._instant(0.0, self._begun, (step.levers, step.commands))
        before, in_force = self.now, (step.levers, step.commands)
        self._rows += 1
        time = round(self._rows * PERIOD, 6)
        self._course.move(time, step.motion)
        self.now = self._instant(time, step.motion, in_force)
        return Instant(before.state, step.commands, before.passed, step.levers), self.now

    def at(self, now: float) -> Array:
        """(S,) the newest motion, carried on with its velocity for at most a period."""
        state = self._instant(self.now.state[TIME], self._motion, self._in_force).state
        age = min(max(now - self._latest.came, 0.0), PERIOD)
        rates = over_ground(state) | turning(state)
        for place in (NORTH, EAST, HEADING):
            state[place] += age * rates[place]
        return state

    def weather(self, state: Array) -> None:
        """Unknown."""

    def about(self) -> dict[str, Any]:
        """The vehicle's address, and how many rows' motion was interpolated."""
        return {"link": self._address, "interpolated_rows": self._interpolated}

    def warm(self, seed: int) -> None:
        """Nothing: `__init__` has called what is compiled."""

    def _late(self, now: float) -> float:
        """Since the time of the next commands [s], below 0 before it."""
        return -math.inf if self._started is None else now - self._started - self._period * PERIOD

    def _hear(self, now: float) -> None:
        self._cut |= self._under_way and self._late(now) > HOLD
        for _ in range(AT_ONCE):
            if (packet := self._link.receive(0.0)) is None:
                return
            self._latest.feed(packet, now)
            if self._latest.stamp != self._used:
                self._take(now)

    def _take(self, now: float) -> None:
        """A sample has come: it ends the steps that were under way."""
        stamp, motion = self._latest.stamp, self._latest.senses
        assert stamp is not None
        if self._started is None:
            self._started, self._period = now + LEAD, 0
        if self._first >= 0 and not self._cut:
            assert self._used is not None
            self._divide((self._used - self._first) / 1e6, (stamp - self._first) / 1e6, motion)
        self._used, self._motion, self._sent = stamp, motion, []

    def _divide(self, start: float, end: float, motion: Array) -> None:
        """Add the steps that end after the sample at `start` [s] and not after the one at `end`."""
        sent = self._sent or [self._in_force]
        turn = motion - self._motion
        turn[2] = wrapped(turn[2])
        row = self._rows + len(self._steps) + 1
        for number in range(math.floor(end / PERIOD + EVEN) - row + 1):
            share = ((row + number) * PERIOD - start) / (end - start)
            self._interpolated += (1.0 - share) * (end - start) > EVEN * PERIOD
            levers, commands = sent[min(number, len(sent) - 1)]
            self._steps.append(_Step(self._motion + min(share, 1.0) * turn, levers, commands))

    def _send(self, levers: Levers, stern: Levers) -> None:
        if self._period < SETTLE:
            levers, stern = IDLE, IDLE
        commands = self._course.commands(levers, stern)
        if self._silent:
            commands[len(commands) // 2 :] = 0.0
        send_period(self._link, self._period, commands)
        self._in_force = (levers, commands)
        self._sent.append(self._in_force)
        if self._under_way and self._first < 0 and self._used is not None:
            self._first, self._begun, self._sent = self._used, self._motion, [self._in_force]

    def _wait(self, now: float) -> None:
        """Switch the motors off, if they are on, and ask for telemetry now and then."""
        if self._started is not None:
            stop(self._link, len(self.boat.thrusters))
            self._started, self._in_force = None, (IDLE, self._course.commands(IDLE))
        if now - self._asked >= ASK_AGAIN:
            self._link.ask()
            self._asked = now

    def _instant(self, time: float, motion: Array, in_force: tuple[Levers, Array]) -> Instant:
        state = np.zeros(state_size(len(self.boat.thrusters)))
        state[NORTH : YAW_RATE + 1], state[TIME] = motion, time
        state[ACTUATORS:] = in_force[1]
        return Instant(state, in_force[1], self._course.passed, in_force[0])
