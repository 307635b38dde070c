"""The two computers on a virtual vehicle, and what may fail: simulated, step by step (thesis 6.5)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.link.computer import PORT, STARBOARD, Computer, Heartbeat
from swamp_rl.allocation import Jets, jets_of
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.link.addresses import FIRST_COMPUTER, LOOPBACK, addresses
from swamp_rl.link.helm import PERIOD
from swamp_rl.link.module_line import read_module_line
from swamp_rl.link.network import PERFECT, Faults, Network
from swamp_rl.link.protocol import (
    AZIMUTH_MOTOR,
    ENABLE,
    POWER,
    REFERENCE,
    TELEMETRY_TO,
    THRUST_MOTOR,
    Command,
    encoded,
    throttle_reference,
)
from swamp_rl.link.sensor_line import read_sensor_line, words_of
from swamp_rl.link.vehicle import TICK, Packet, Vehicle, refuse_other_thrusters
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.runs.thruster_telemetry import FIRST_MODULE, azimuth_angle, azimuth_steps
from swamp_rl.simulator.state import ACTUATORS

Array = NDArray[np.float64]

HULLS = ("starboard", "port")
"""By the number of their computer."""
COPIES = 3
"""Of each heartbeat on the wireless link, for a hull must not count as lost where a few datagrams are; and of
what a module is asked that may be new: references, and whom to answer."""
PHASES = (0, 6)
"""Ticks after each period at which the computers decide: nothing makes them step together."""


class Pair:
    """A boat of two hulls, its computers, and a console on shore that wishes for a force.

    Dead parts are added to `dead_computers`, `dead_communications` (hulls' numbers), `vehicle.dead` (modules
    and sensors), `vehicle.blind`; `cut`: the wireless link between the hulls carries nothing.
    """

    def __init__(self, boat: Boat, faults: Faults = PERFECT, seed: int = 0) -> None:
        """faults: of the network between the hulls and to the modules. UserError for a boat without a jet on
        either side."""
        refuse_other_thrusters(boat)
        own = [frozenset(k for k, one in enumerate(boat.thrusters) if side * one.y > 0.0) for side in (1, -1)]
        if not all(own):
            raise UserError(
                f"boat {boat.name}: has no jets on both sides; two computers need a boat of two hulls"
            )
        self.vehicle = Vehicle(boat, addresses(LOOPBACK, len(boat.thrusters), 2))
        self.jets: Jets = jets_of(boat)
        self.computers = [Computer(number, hull, self.jets) for number, hull in enumerate(own)]
        self.wish: Sequence[float] = (0.0, 0.0, 0.0)
        "What the console sends ten times a second: surge, sway force [N] and yaw moment [N m]."
        self.dead_computers: set[int] = set()
        self.dead_communications: set[int] = set()
        self.cut = False
        self.commanders: list[int | None] = [None for _ in boat.thrusters]
        "Which computer each module heard last."
        self._wireless: Network[Heartbeat] = Network(faults, seed)
        self._to_modules: Network[tuple[int, int, bytes]] = Network(faults, seed + 1)

    @property
    def time(self) -> float:
        """Since the start [s]."""
        return self.vehicle.time

    def empty_battery(self, hull: int) -> None:
        """A hull without power: its computer, communication, sensors and modules are dead at once."""
        self.dead_computers.add(hull)
        self.dead_communications.add(hull)
        self.vehicle.dead.add(self.vehicle.addresses.sensors[hull])
        self.vehicle.dead.update(self.vehicle.addresses.modules[k] for k in self.computers[hull].own)

    def break_module(self, name: str) -> None:
        """The thruster's module is dead."""
        self.vehicle.dead.add(self.vehicle.addresses.modules[self.jets.names.index(name)])

    def working(self) -> Jets:
        """The jets that can push, whoever commands them."""
        ends = self.vehicle.addresses.modules
        return self.jets.without(
            [n for n, end in zip(self.jets.names, ends, strict=True) if end in self.vehicle.dead]
        )

    def force(self) -> Array:
        """(3,) surge, sway force [N] and yaw moment [N m] of the jets as they stand now, at rest."""
        return self._force_of(self.vehicle.state[0, ACTUATORS:])

    def commanded_force(self) -> Array:
        """As `force`, of the commands in force, once the jets have turned."""
        return self._force_of(self.vehicle.commands())

    def _force_of(self, actuators: Array) -> Array:
        azimuths, throttles = np.split(actuators, 2)
        record = self.jets.record[0]
        thrust = np.array([effective_thrust(p, k, record) for k, p in enumerate(throttles.tolist())])
        parts = thrust[:, None] * np.column_stack([np.cos(azimuths), np.sin(azimuths)])
        return self.jets.geometry @ parts.ravel()

    def step(self) -> None:
        """Let TICK pass."""
        for packet in self.vehicle.advance(self.time + TICK):
            self._deliver(packet)
        now = self.time
        for hull, computer in enumerate(self.computers):
            if hull not in self.dead_computers and self._decides(hull):
                self._hear_console(computer, now)
                self._tell(computer, now)
                self._command(computer, now)
        self._carry(now)

    def _decides(self, hull: int) -> bool:
        return self.vehicle.ticks % round(PERIOD / TICK) == PHASES[hull]

    def _hear_console(self, computer: Computer, now: float) -> None:
        if computer.number not in self.dead_communications:
            computer.hear_wish(self.wish, now)

    def _tell(self, computer: Computer, now: float) -> None:
        """Send a heartbeat by the wireless link between the hulls, and through both communication modules."""
        beat, other = computer.heartbeat(now), self.computers[1 - computer.number]
        if not self.cut:
            for _ in range(COPIES):
                self._wireless.send(beat, now)
        if not self.dead_communications and other.number not in self.dead_computers:
            other.hear_other(beat, now)

    def _command(self, computer: Computer, now: float) -> None:
        commands, K = computer.commands(now), len(self.jets.names)
        byte, port = FIRST_COMPUTER + computer.number, self.vehicle.addresses.recipient[1]
        for k in computer.commanded(now):
            if self.cut and k not in computer.own:
                continue
            on = [
                Command(code, (motor, 1))
                for code in (POWER, ENABLE)
                for motor in (THRUST_MOTOR, AZIMUTH_MOTOR)
            ]
            azimuth = Command(REFERENCE, (AZIMUTH_MOTOR, azimuth_steps(float(commands[k]))))
            thrust = Command(REFERENCE, (THRUST_MOTOR, throttle_reference(float(commands[K + k]))))
            for command in (*on, *COPIES * (Command(TELEMETRY_TO, (byte, port)), azimuth, thrust)):
                self._to_modules.send((computer.number, k, encoded(command)), now)

    def _carry(self, now: float) -> None:
        """What is on its way arrives."""
        for beat in self._wireless.arrived(now):
            other = self.computers[1 - beat.sender]
            if other.number not in self.dead_computers:
                other.hear_other(beat, now)
        for sender, k, datagram in self._to_modules.arrived(now):
            end = self.vehicle.addresses.modules[k]
            self.vehicle.receive(datagram, self.vehicle.addresses.sensors[sender], end)
            if end not in self.vehicle.dead:
                self.commanders[k] = sender

    def _deliver(self, packet: Packet) -> None:
        """Telemetry: of sensors to the computer that they are in, of a module to its recipients."""
        words = words_of(packet.payload)
        ends = self.vehicle.addresses
        if packet.source in ends.sensors:
            computer = self.computers[ends.sensors.index(packet.source)]
            if packet.source not in self.vehicle.blind and packet.to == ends.recipient:
                read_sensor_line(words, self.vehicle.conduct.origin)
                computer.fixed = self.time
            return
        line, host = read_module_line(words), int(packet.to[0].rpartition(".")[2]) - FIRST_COMPUTER
        k = line.sender - FIRST_MODULE
        if host in (STARBOARD, PORT) and host not in self.dead_computers:
            computer = self.computers[host]
            if k in computer.own or not self.cut:
                computer.hear_module(k, azimuth_angle(line.azimuth_actual), self.time)
