"""A link to a virtual vehicle in simulated time, over a network with faults: as fast as the machine goes."""

from collections import deque

from swamp_rl.link.addresses import Endpoint
from swamp_rl.link.network import PERFECT, Faults, Network
from swamp_rl.link.protocol import Command, encoded
from swamp_rl.link.vehicle import Packet, Vehicle

INSTANT = 0.001
"""Resolution of arrival times [s]."""


class SimulatedLink:
    """What `SocketLink` is to a served vehicle, from the default recipient's endpoint; `clock` is its time.

    telemetry: the faults on the way from the vehicle, `faults` by default. `log`: every telemetry packet that
    the vehicle sent.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        faults: Faults = PERFECT,
        seed: int = 0,
        telemetry: Faults | None = None,
    ) -> None:
        self.vehicle, self.faults = vehicle, faults
        self.own: Endpoint = vehicle.addresses.recipient
        self._now = vehicle.time
        self._to_vehicle: Network[tuple[bytes, Endpoint]] = Network(faults, seed)
        self._from_vehicle: Network[Packet] = Network(telemetry or faults, seed + 1)
        self._waiting: deque[bytes] = deque()
        self.log: list[bytes] = []

    def clock(self) -> float:
        """The time [s]."""
        return self._now

    def ask(self) -> None:
        """Nothing: the default recipient has the telemetry unasked."""

    def send(self, k: int, command: Command) -> None:
        """Send a command to the module of thruster k."""
        self._to_vehicle.send((encoded(command), self.vehicle.addresses.modules[k]), self._now)

    def receive(self, timeout: float) -> bytes | None:
        """The next packet, None where none comes for `timeout` [s] of the link's time."""
        end = self._now + timeout
        while not self._waiting and self._now < end:
            self.pass_time(min(self._now + INSTANT, end))
        return self._waiting.popleft() if self._waiting else None

    def pass_time(self, until: float) -> None:
        """Let the vehicle sail and datagrams arrive up to the time `until` [s]."""
        self._now = until
        for datagram, to in self._to_vehicle.arrived(self._now):
            self.vehicle.receive(datagram, self.own, to)
        for packet in self.vehicle.advance(self._now):
            self.log.append(packet.payload)
            if packet.to == self.own:
                self._from_vehicle.send(packet, self._now)
        self._waiting += [packet.payload for packet in self._from_vehicle.arrived(self._now)]
