"""Drive whatever answers at a link: telemetry in, a pilot's commands out at 10 Hz."""

import gc
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.link.priority import garbage_kept
from swamp_rl.link.protocol import (
    AZIMUTH_MOTOR,
    ENABLE,
    MAX_SPEED,
    POWER,
    REFERENCE,
    THRUST_MOTOR,
    Command,
    throttle_reference,
)
from swamp_rl.link.sensor_line import CAMOGLI, read_sensor_line, words_of
from swamp_rl.link.socket_link import PATIENCE
from swamp_rl.link.stamps import Stamps
from swamp_rl.runs.local_frame import Place, from_local
from swamp_rl.runs.thruster_telemetry import azimuth_steps

Array = NDArray[np.float64]

PERIOD = 0.1
"""Seconds between two commands: the rate at which the pilots were trained."""
LEAD = 0.004
"""Time [s] from the first telemetry to the first command's schedule: each then has a sample of its own."""
HOLD = 0.5
"""Seconds for which a pilot may go on without new telemetry; then the pumps are stopped."""
SETTLE = 10
"""Periods at the start in which the motors are switched on and the jets turn ahead, without thrust: the first
datagrams may be lost, and the log begins with commands that are known to be in force."""
AGAIN = 10
"""Periods after which power and enabling are asked for again, for any datagram may have been lost."""
MOTOR_SPEED = 7000
"""RPM of the azimuth's motor that is allowed, as in the thesis's example (6.2)."""
STOPS = 3
"""Times that the last commands are sent."""


class Link(Protocol):
    """What is asked of a link, see `swamp_rl.link.socket_link`."""

    def ask(self) -> None:
        """Ask for telemetry."""

    def receive(self, timeout: float) -> bytes | None:
        """The next packet, None where none comes for `timeout` [s]."""

    def send(self, k: int, command: Command) -> None:
        """Send a command to the module of thruster k."""


class Bridge(Protocol):
    """What decides, see `swamp_rl.envs.aboard`."""

    levers: Array
    "(2,) throttle and angle asked last."

    @property
    def outcome(self) -> str | None:
        """How it ended, None while it has not."""

    def decide(self, time: float, senses: Array) -> Array:
        """Commands (2K,) for the motion (6,) at a time [s]."""


@dataclass
class Voyage:
    """What a helm did. rows: time [s], motion (6,), levers (2,), commands (2K,); lateness: of each command
    against the schedule [s]; `ignored` packets; `missed` periods, too late to be kept; `silent` periods
    without fresh telemetry; how it ended, None where the link fell silent."""

    rows: list[Array] = field(default_factory=list)
    lateness: list[float] = field(default_factory=list)
    ignored: int = 0
    missed: int = 0
    silent: int = 0
    outcome: str | None = None


class Latest:
    """The newest motion of those in telemetry packets, and when it came."""

    def __init__(self, origin: Place) -> None:
        self._origin = origin
        from_local(np.zeros(1), np.zeros(1), origin)  # its library takes a second once: not under way
        self.stamp: int | None = None
        "Of the newest [µs], on a time that goes on where the sender's clock is set."
        self._stamps = Stamps()
        self.senses = np.zeros(6)
        self.came = -math.inf
        self.ignored = 0

    def feed(self, packet: bytes, now: float) -> None:
        """Take a packet that came at `now` [s]; what is no newer motion is counted."""
        try:
            words = words_of(packet)
            stamp, senses = read_sensor_line(words, self._origin)
        except (ValueError, OverflowError):
            self.ignored += 1
            return
        followed = self._stamps.follow(stamp)
        if followed is None:
            self.ignored += 1
            return
        self.stamp, self.senses, self.came = followed, senses, now


def helm(
    link: Link,
    bridge: Bridge,
    thrusters: int,
    clock: Callable[[], float],
    seconds: float = math.inf,
    origin: Place = CAMOGLI,
    voyage: Voyage | None = None,
) -> Voyage:
    """Let a bridge drive at 10 Hz until its course has ended, `seconds` are over or the link is silent.

    The motors are switched on first, and stopped and switched off at the end, whatever ends it. clock: [s],
    the one that `link.receive` waits by. voyage: filled as it goes, for a caller that interrupts. Its outcome
    is None where no telemetry came for PATIENCE.
    """
    voyage = voyage or Voyage()
    latest = Latest(origin)
    try:
        with garbage_kept():  # collected at first, before the schedule begins
            if await_first(link, latest, clock):
                _drive(link, bridge, thrusters, clock, seconds, latest, voyage)
    finally:
        voyage.ignored = latest.ignored
        stop(link, thrusters)
    return voyage


def await_first(link: Link, latest: Latest, clock: Callable[[], float]) -> bool:
    """Whether a first sample comes within PATIENCE."""
    begin = clock()
    while latest.stamp is None and clock() - begin < PATIENCE:
        link.ask()
        if (packet := link.receive(PATIENCE / 4)) is not None:
            latest.feed(packet, clock())
    return latest.stamp is not None


def switch_on(link: Link, thrusters: int) -> None:
    """Power and enable all motors, and allow the azimuths their speed."""
    for k in range(thrusters):
        for opcode in (POWER, ENABLE):
            for motor in (THRUST_MOTOR, AZIMUTH_MOTOR):
                link.send(k, Command(opcode, (motor, 1)))
        link.send(k, Command(MAX_SPEED, (MOTOR_SPEED,)))


def stop(link: Link, thrusters: int) -> None:
    """Stop the pumps, disable the motors and take their power."""
    for _ in range(STOPS):
        for k in range(thrusters):
            link.send(k, Command(REFERENCE, (THRUST_MOTOR, 0)))
            for opcode in (ENABLE, POWER):
                for motor in (THRUST_MOTOR, AZIMUTH_MOTOR):
                    link.send(k, Command(opcode, (motor, 0)))


def steer(link: Link, commands: Array) -> None:
    """Send references for commands (2K,)."""
    K = len(commands) // 2
    for k in range(K):
        link.send(k, Command(REFERENCE, (AZIMUTH_MOTOR, azimuth_steps(float(commands[k])))))
        link.send(k, Command(REFERENCE, (THRUST_MOTOR, throttle_reference(float(commands[K + k])))))


def send_period(link: Link, period: int, commands: Array) -> None:
    """Send commands (2K,) in a period, counted from the start; power and enabling too where they are due."""
    if period < SETTLE or period % AGAIN == 0:
        switch_on(link, len(commands) // 2)
    steer(link, commands)


def _drive(
    link: Link,
    bridge: Bridge,
    thrusters: int,
    clock: Callable[[], float],
    seconds: float,
    latest: Latest,
    voyage: Voyage,
) -> None:
    start, first = latest.came + LEAD, latest.stamp
    assert first is not None
    commands, period, used, begun = np.zeros(2 * thrusters), 0, None, None
    while bridge.outcome is None and period * PERIOD < seconds:
        due = start + period * PERIOD
        hear(link, latest, clock, due)
        if clock() - latest.came > PATIENCE:
            return
        assert latest.stamp is not None
        if latest.stamp != used:
            used = latest.stamp
            if period >= SETTLE:
                begun = begun or used
                commands = bridge.decide((used - begun) / 1e6, latest.senses)
            time = (used - first) / 1e6
            voyage.rows.append(np.concatenate([[time], latest.senses, bridge.levers, commands]))
        else:
            voyage.silent += 1
            link.ask()
        if clock() - latest.came > HOLD:
            commands[thrusters:] = 0.0
        voyage.lateness.append(clock() - due)
        send_period(link, period, commands)
        gc.collect(0 if period % AGAIN else 1)  # now, when there is time until the next command
        late = math.floor((clock() - due) / PERIOD)
        voyage.missed += late
        period += 1 + late
    voyage.outcome = bridge.outcome or "ended"


def hear(link: Link, latest: Latest, clock: Callable[[], float], until: float) -> None:
    """Take what telemetry comes up to a time of the clock [s]."""
    while (left := until - clock()) > 0.0:
        if (packet := link.receive(left)) is not None:
            latest.feed(packet, clock())
