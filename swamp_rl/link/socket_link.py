"""A socket to a vehicle: ask for its telemetry, hear what comes, send commands."""

import select
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from swamp_rl.errors import UserError
from swamp_rl.link.addresses import RECIPIENT, Addresses
from swamp_rl.link.protocol import INSERT_RECIPIENT, REMOVE_RECIPIENT, TELEMETRY_TO, Command, encoded

LARGEST = 2048
"""Bytes of a packet that is read; a telemetry line has some 450."""
PATIENCE = 3.0
"""Seconds without telemetry after which a link is given up."""
ASK_AGAIN = 1.0
"""Seconds without telemetry after which it is asked for again: the first request may have been lost."""


class SocketLink:
    """One end of a link. modules: whether the thruster modules are asked for their telemetry too; they leave
    their former recipient for it, for they have but one."""

    def __init__(self, vehicle: Addresses, modules: bool = False) -> None:
        """UserError where this machine has no address in the vehicle's network."""
        self.vehicle, self._modules = vehicle, modules
        self._socket = bound(vehicle)
        address, self._port = self._socket.getsockname()
        self._byte = int(address.rpartition(".")[2])
        self.foreign = 0
        "Packets from outside the vehicle's network."

    def ask(self) -> None:
        """Ask the vehicle to send its telemetry here."""
        for sensors in self.vehicle.sensors:
            self._send(Command(INSERT_RECIPIENT, (self._byte, self._port)), sensors)
        if self._modules:
            for k in range(len(self.vehicle.modules)):
                self.send(k, Command(TELEMETRY_TO, (self._byte, self._port)))

    def send(self, k: int, command: Command) -> None:
        """Send a command to the module of thruster k. A network that refuses it loses it, as any datagram."""
        self._send(command, self.vehicle.modules[k])

    def receive(self, timeout: float) -> bytes | None:
        """The next packet from the vehicle's network, None where none comes for `timeout` [s]."""
        end = time.monotonic() + timeout
        while True:
            # select keeps to microseconds; a socket's own timeout is rounded up to milliseconds
            ready, _, _ = select.select([self._socket], [], [], max(end - time.monotonic(), 0.0))
            if not ready:
                return None
            with suppress(OSError):  # the system may tell of a datagram of ours that nobody took
                packet, sender = self._socket.recvfrom(LARGEST)
                if self.vehicle.allows(sender[0]):
                    return packet
                self.foreign += 1
            if time.monotonic() >= end:  # however many foreign ones wait
                return None

    def close(self) -> None:
        """Let go of the telemetry: the modules' goes to the default recipient again."""
        for sensors in self.vehicle.sensors:
            self._send(Command(REMOVE_RECIPIENT, (self._byte, self._port)), sensors)
        if self._modules:
            address, port = self.vehicle.recipient
            for k in range(len(self.vehicle.modules)):
                self.send(k, Command(TELEMETRY_TO, (int(address.rpartition(".")[2]), port)))
        self._socket.close()

    def _send(self, command: Command, to: tuple[str, int]) -> None:
        with suppress(OSError):
            self._socket.sendto(encoded(command), to)


@contextmanager
def socket_link(vehicle: Addresses, modules: bool = False) -> Iterator[SocketLink]:
    """A link that is let go of at the end of the block."""
    link = SocketLink(vehicle, modules)
    try:
        yield link
    finally:
        link.close()


def packets(link: SocketLink, patience: float) -> Iterator[bytes]:
    """Yield telemetry packets without end; UserError where none comes for `patience` [s]."""
    silent = 0.0
    link.ask()
    while silent < patience:
        wait = min(ASK_AGAIN, patience - silent)
        packet = link.receive(wait)
        if packet is None:
            silent += wait
            link.ask()
        else:
            silent = 0.0
            yield packet
    raise no_answer(link.vehicle, patience)


def no_answer(vehicle: Addresses, patience: float) -> UserError:
    """Message where a vehicle is silent."""
    return UserError(
        f"{vehicle.text}: no telemetry for {patience:g} s; check that the vehicle is on and that this is its "
        "address"
    )


def bound(vehicle: Addresses) -> socket.socket:
    """A UDP socket at a free port of this machine's address in the vehicle's network."""
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        own.bind((_own_address(vehicle), 0))
    except OSError as error:
        own.close()
        raise UserError(f"{vehicle.text}: cannot be reached from here ({error.strerror})") from error
    return own


def _own_address(vehicle: Addresses) -> str:
    if vehicle.network.prefixlen < 32 and vehicle.network.is_loopback:
        return vehicle.with_byte(RECIPIENT)
    # Connecting sends nothing; it tells which of this machine's addresses leads there.
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(vehicle.sensors[0])
        return str(probe.getsockname()[0])
