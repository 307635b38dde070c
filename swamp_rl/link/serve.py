"""A virtual vehicle in real time: its endpoints as UDP sockets, its packets sent and logged."""

import selectors
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from swamp_rl.errors import UserError
from swamp_rl.files import os_error
from swamp_rl.link.addresses import Endpoint
from swamp_rl.link.protocol import LONGEST
from swamp_rl.link.vehicle import TICK, Packet, Vehicle

BEHIND = 0.5
"""How far [s] the boat may lag behind the clock; what a stalled machine lost beyond is not made up for."""
AT_ONCE = 100
"""Datagrams of an endpoint that are taken before the vehicle sails on."""
Sockets = dict[Endpoint, socket.socket]


@contextmanager
def endpoints(vehicle: Vehicle) -> Iterator[Sockets]:
    """Sockets of the vehicle's modules and sensors' programs; UserError for one that cannot be had."""
    with ExitStack() as stack:
        found: Sockets = {}
        for end in (*vehicle.addresses.modules, *vehicle.addresses.sensors):
            own = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            try:
                own.bind(end)
            except OSError as error:
                raise UserError(
                    f"{vehicle.addresses.text}: {end[0]}:{end[1]} cannot be served ({error.strerror}); give "
                    "another --address"
                ) from error
            own.setblocking(False)
            found[end] = own
        yield found


@contextmanager
def telemetry_log(path: Path | None) -> Iterator[BinaryIO | None]:
    """A new file for telemetry lines, as `runs import --from telemetry` reads them; None where none is asked
    for. UserError where it exists or cannot be written."""
    if path is None:
        yield None
        return
    try:
        log = path.open("xb")
    except FileExistsError:
        raise UserError(f"{path}: already exists; name another file for the log") from None
    except OSError as error:
        raise os_error(error, path) from error
    with log:
        yield log


def serve(
    vehicle: Vehicle,
    sockets: Sockets,
    log: BinaryIO | None = None,
    ended: Callable[[], bool] = lambda: False,
    clock: Callable[[], float] = time.monotonic,
) -> None:
    """Let the vehicle sail and answer until it has `ended`, in the time of a clock [s]."""
    with selectors.DefaultSelector() as selector:
        for end, own in sockets.items():
            selector.register(own, selectors.EVENT_READ, end)
        start = clock() - vehicle.time
        while not ended():
            due = start + vehicle.time + TICK
            ready = selector.select(max(due - clock(), 0.0))
            now = clock()
            start = max(start, now - vehicle.time - BEHIND)
            send(vehicle.advance(now - start), sockets, log)
            for key, _ in ready:
                receive(vehicle, sockets[key.data], key.data)


def receive(vehicle: Vehicle, own: socket.socket, end: Endpoint) -> None:
    """Hand the datagrams that wait at an endpoint to the vehicle, at most AT_ONCE: it must sail meanwhile."""
    for _ in range(AT_ONCE):
        try:
            datagram, sender = own.recvfrom(LONGEST + 1)
        except OSError:  # none waits, or the system tells of one of ours that nobody took
            return
        vehicle.receive(datagram, sender, end)


def send(packets: list[Packet], sockets: Sockets, log: BinaryIO | None) -> None:
    """Send packets, and write each line once to the log; UserError where the disk refuses it."""
    for packet in packets:
        with suppress(OSError):  # as any datagram, it may be lost
            sockets[packet.source].sendto(packet.payload, packet.to)
    if log is not None:
        try:
            log.writelines(dict.fromkeys(packet.payload for packet in packets))
        except OSError as error:
            raise os_error(error, log.name) from error
