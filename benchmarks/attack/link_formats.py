"""What comes by the network or as a recording of it: datagrams to a vehicle and from one, each line one."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.attack.samples import make_mcap, make_text
from swamp_rl.errors import UserError

Make, Read = Callable[[Path], Path], Callable[[Path], Any]
COMMANDS = "1002 0 1\n1003 0 1\n1002 1 1\n1003 1 1\n1004 0 30000\n1004 1 -123853\n1005 7000\n1007\n10001 1"
TO_SENSORS = "10001 100 2969\n10002 100 2969\n10000 1"


@functools.cache
def _boat() -> Any:
    """Loaded once: no input changes it, and most of the time would go into its file."""
    from swamp_rl.boat import load_boat

    return load_boat("swamp")


def _vehicle() -> Any:
    from swamp_rl.link.addresses import addresses
    from swamp_rl.link.vehicle import Vehicle

    return Vehicle(_boat(), addresses("127.0.0.0/24", 4))


def make_telemetry_packets(folder: Path) -> Path:
    """Of a vehicle under way, half a second."""
    packets = [packet.payload for packet in _vehicle().advance(0.5)]
    (folder / "packets").write_bytes(b"".join(packets))
    return folder / "packets"


def _obeyed(sensors: bool) -> Read:
    def read(path: Path) -> Any:
        vehicle = _vehicle()
        ends = vehicle.addresses
        to = ends.sensors[0] if sensors else ends.modules[0]
        for datagram in path.read_bytes().split(b"\n"):
            vehicle.receive(datagram, (ends.recipient[0], 2969), to)
        vehicle.advance(0.2)
        if vehicle.ignored:
            raise UserError(", ".join(vehicle.ignored))

    return read


def _heard(path: Path) -> Any:
    """What a watcher and a helm make of the packets."""
    import numpy as np

    from swamp_rl.link.helm import Latest
    from swamp_rl.link.sensor_line import CAMOGLI
    from swamp_rl.link.stream import Assembler

    assembler, latest = Assembler(_boat()), Latest(CAMOGLI)
    for number, packet in enumerate(path.read_bytes().split(b"\n")):
        sample = assembler.feed(packet[:2048])
        latest.feed(packet[:2048], 0.1 * number)
        assert sample is None or np.isfinite([*sample.senses, *sample.commands, sample.time]).all()
        assert np.isfinite(latest.senses).all()
    if assembler.ignored > 1:  # the last is empty
        raise UserError(f"{assembler.ignored} packets ignored")


def _watched(path: Path) -> Any:
    from swamp_rl.link.stream import samples

    return list(samples(path, _boat()))


LINK_FORMATS: dict[str, tuple[Make, Read]] = {
    "datagrams to a module": (make_text(COMMANDS), _obeyed(False)),
    "datagrams to the sensors": (make_text(TO_SENSORS), _obeyed(True)),
    "telemetry packets": (make_telemetry_packets, _heard),
    "watch, run.mcap": (make_mcap, _watched),
}
"""Of each name the maker and the reader."""
