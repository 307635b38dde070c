"""A virtual vehicle: the simulator behind thruster modules and sensors, without sockets or a clock."""

import math
from collections import Counter
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, Thruster
from swamp_rl.errors import UserError
from swamp_rl.link.addresses import FIRST_COMPUTER, Addresses, Endpoint
from swamp_rl.link.module import GEAR, TIMEOUT, ThrusterModule
from swamp_rl.link.module_line import ModuleLine, module_line
from swamp_rl.link.protocol import (
    AZIMUTH_MOTOR,
    INSERT_RECIPIENT,
    MODULE,
    REMOVE_RECIPIENT,
    SENSORS,
    THRUST_MOTOR,
    DatagramError,
    decoded,
)
from swamp_rl.link.sensor_line import CAMOGLI, sensor_line
from swamp_rl.navigation.sensors import Sensors
from swamp_rl.runs.local_frame import Place
from swamp_rl.runs.thruster_telemetry import (
    FIRST_MODULE,
    FULL,
    STEPS_PER_TURN,
    azimuth_angle,
    azimuth_steps,
)
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.state import ACTUATORS, NORTH, YAW_RATE

Array = NDArray[np.float64]

TICK = 0.005
"""Seconds of a step of the simulator: a command acts from the next one on."""
TELEMETRY_TICKS = 20
"""Steps between two telemetry packets of each sender."""
EPOCH = 1_568_455_200_000_000
"""Stamp [µs] at time 0 where the caller gives none: 14 September 2019, the days of Camogli (thesis 7.3.3)."""
MOST_RECIPIENTS = 8
"""That the sensors' program keeps; further ones are ignored."""
MOST_DATAGRAMS = 1000
"""Of any senders in a second; further ones are ignored."""


class Packet(NamedTuple):
    """A datagram that the vehicle sends."""

    payload: bytes
    source: Endpoint
    to: Endpoint


@dataclass(frozen=True)
class Conduct:
    """How a virtual vehicle behaves.

    timeout: [s] of its modules without a command; steps_per_turn: of the azimuths' encoders; noise: of the
    sensors, none by default; seed: of noise and gusts; epoch: [µs] at time 0.
    """

    timeout: float = TIMEOUT
    steps_per_turn: float = STEPS_PER_TURN
    noise: Sensors | None = None
    seed: int = 0
    epoch: int = EPOCH
    origin: Place = CAMOGLI


class Vehicle:
    """One boat that obeys datagrams and answers by telemetry; every time is given by the caller."""

    def __init__(
        self, boat: Boat, vehicle: Addresses, pose: Array | None = None, conduct: Conduct | None = None
    ) -> None:
        """pose: (3,) north, east [m], heading [rad] at time 0. UserError for a boat without azimuth jets."""
        refuse_other_thrusters(boat)
        self.boat, self.addresses, self.conduct = boat, vehicle, conduct or Conduct()
        self.params = parameters(boat)
        "(1,) parameter record; may be changed under way."
        self._tank = tank(boat)
        self.state = initial_state(self.params, np.zeros((1, 3)) if pose is None else pose[None])
        "(1, S), see `swamp_rl.simulator.state`."
        self.modules = [ThrusterModule(vehicle, self.conduct.timeout) for _ in boat.thrusters]
        self.dead: set[Endpoint] = set()
        "Modules and sensors' programs that have broken down: they neither hear, nor send, nor turn anything."
        self.blind: set[Endpoint] = set()
        "Sensors' programs whose GPS has no fix."
        self.recipients: dict[Endpoint, list[Endpoint]] = {
            end: [vehicle.recipient] for end in vehicle.sensors
        }
        self.ignored: Counter[str] = Counter()
        "Datagrams that were not obeyed, by reason."
        self.ticks = 0
        self._rate_limit = self.params["azimuth_rate"].copy()
        self._rng = np.random.default_rng(self.conduct.seed)
        self._gusts = self._rng.integers(2**63, size=1).astype(np.uint64)
        self._sent: list[tuple[int, int] | None] = [None for _ in boat.thrusters]
        self._asked: list[Array] = []
        self._second, self._in_second = 0, 0

    @property
    def time(self) -> float:
        """Since the start [s]."""
        return self.ticks * TICK

    def receive(self, datagram: bytes, sender: Endpoint, to: Endpoint) -> None:
        """Take a datagram; what is not a command for that endpoint is counted in `ignored` and no more."""
        try:
            self._obey(datagram, sender, to)
        except DatagramError as error:
            self.ignored[str(error)] += 1

    def advance(self, until: float) -> list[Packet]:
        """Sail to the time `until` [s], as far as whole steps go; what is sent on the way, in order."""
        sent: list[Packet] = []
        while (self.ticks + 1) * TICK <= until + 1e-9:
            if self.ticks == 0:
                sent += self._telemetry()
            self._sail()
            sent += self._telemetry() if self.ticks % TELEMETRY_TICKS == 0 else self._changes()
        return sent

    def commands(self) -> Array:
        """(2K,) azimuths [rad] and throttles [1] in force: of an azimuth that is off, where it stands."""
        K = len(self.modules)
        found = np.concatenate([self.state[0, ACTUATORS : ACTUATORS + K], np.zeros(K)])
        for k, module in enumerate(self.modules):
            if self.addresses.modules[k] in self.dead:
                continue
            if module.steps is not None:
                found[k] = azimuth_angle(module.steps, self.conduct.steps_per_turn)
            found[K + k] = module.throttle / FULL
        return found

    def _obey(self, datagram: bytes, sender: Endpoint, to: Endpoint) -> None:
        if not self.addresses.allows(sender[0]):
            raise DatagramError("foreign")
        self._limit()
        if to in self.dead:
            raise DatagramError("broken down")
        if to in self.recipients:
            command = decoded(datagram, SENSORS)
            if command.opcode in (INSERT_RECIPIENT, REMOVE_RECIPIENT):
                self._change_recipients(command.opcode, self.recipients[to], command.arguments)
        else:
            self.modules[self.addresses.modules.index(to)].obey(decoded(datagram, MODULE), self.time)

    def _limit(self) -> None:
        if int(self.time) != self._second:
            self._second, self._in_second = int(self.time), 0
        self._in_second += 1
        if self._in_second > MOST_DATAGRAMS:
            raise DatagramError("too many")

    def _change_recipients(self, opcode: int, known: list[Endpoint], given: tuple[int, ...]) -> None:
        end = (self.addresses.with_byte(given[0]), given[1])
        if opcode == REMOVE_RECIPIENT:
            known[:] = [kept for kept in known if kept != end]
        elif end not in known:
            if len(known) >= MOST_RECIPIENTS:
                raise DatagramError("too many recipients")
            known.append(end)

    def _sail(self) -> None:
        for k, module in enumerate(self.modules):
            module.check_sender(self.time)
            limit = math.inf if module.max_speed is None else module.max_speed / 60.0 * 2.0 * math.pi / GEAR
            # never quite still: the simulator divides by it
            self.params["azimuth_rate"][0, k] = max(min(self._rate_limit[0, k], limit), 1e-6)
        delay = float(self.params["command_delay"][0]) / TICK
        self._asked = [*self._asked[-math.ceil(delay) - 2 :], self.commands()]
        arrived = np.empty_like(self._asked[-1])
        delayed_command(np.array(self._asked), len(self._asked) - 1, delay, arrived)
        step(self.state, self.params, self._tank, arrived[None], self._gusts, TICK, 1)
        self.ticks += 1

    def _telemetry(self) -> list[Packet]:
        sent = []
        for end, recipients in self.recipients.items():
            if end in self.dead:
                continue
            sender = FIRST_COMPUTER + self.addresses.sensors.index(end)
            line = sensor_line(
                self._measured(), self._stamp, sender, self.conduct.origin, end not in self.blind
            )
            sent += [Packet(line.encode(), end, to) for to in recipients]
        return sent + [packet for k in range(len(self.modules)) for packet in self._module_packets(k)]

    def _changes(self) -> list[Packet]:
        """Lines of the modules whose references differ from those last sent."""
        changed = [k for k in range(len(self.modules)) if self._references(k) != self._sent[k]]
        return [packet for k in changed for packet in self._module_packets(k)]

    def _measured(self) -> Array:
        if (noise := self.conduct.noise) is not None:
            return noise.motion(self.state[0], self._rng)
        return self.state[0, NORTH : YAW_RATE + 1].copy()

    @property
    def _stamp(self) -> int:
        return self.conduct.epoch + round(self.time * 1e6)

    def _references(self, k: int) -> tuple[int, int]:
        asked, K = self.commands(), len(self.modules)
        return round(FULL * asked[K + k]), azimuth_steps(asked[k], self.conduct.steps_per_turn)

    def _module_packets(self, k: int) -> list[Packet]:
        module, end, K = self.modules[k], self.addresses.modules[k], len(self.modules)
        if end in self.dead or not module.telemetry:
            return []
        self._sent[k] = throttle, steps = self._references(k)
        reached = self.state[0, ACTUATORS:]
        line = ModuleLine(
            FIRST_MODULE + k,
            self._stamp,
            int(module.power[THRUST_MOTOR]),
            int(module.enabled[THRUST_MOTOR]),
            throttle,
            round(FULL * reached[K + k]),
            int(module.power[AZIMUTH_MOTOR]),
            int(module.enabled[AZIMUTH_MOTOR]),
            steps,
            azimuth_steps(reached[k], self.conduct.steps_per_turn),
        )
        return [Packet(module_line(line).encode(), end, module.recipient)]


def refuse_other_thrusters(boat: Boat) -> None:
    """UserError where the protocol has no command for one of the boat's thrusters."""
    for thruster in boat.thrusters:
        if not isinstance(thruster, Thruster) or thruster.reverses:
            raise UserError(
                f"boat {boat.name}: thrusters.{thruster.name}: the protocol has throttles ahead alone and "
                "azimuths; it needs a boat of jets that do not reverse, such as swamp"
            )
