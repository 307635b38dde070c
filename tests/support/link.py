"""Virtual vehicles to talk to: handed their datagrams, or served on a loopback network."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from swamp_rl.boat import Boat, load_boat
from swamp_rl.course import load_course
from swamp_rl.link.addresses import Addresses, addresses
from swamp_rl.link.serve import endpoints, serve
from swamp_rl.link.vehicle import Conduct, Vehicle
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay

START = ("1002 0 1", "1002 1 1", "1003 0 1", "1003 1 1")
"""Power and enable both motors, as the thesis's example begins."""


def swamp() -> Boat:
    return load_boat("swamp")


def vehicle_of(conduct: Conduct | None = None, network: str = "127.0.0.0/24", computers: int = 1) -> Vehicle:
    """SWAMP at rest at the origin, its motors off."""
    boat = swamp()
    return Vehicle(boat, addresses(network, len(boat.thrusters), computers), conduct=conduct)


def at_the_start(conduct: Conduct | None = None) -> Vehicle:
    """SWAMP at the start of the Camogli course."""
    vehicle, pose = vehicle_of(conduct), load_course("camogli").start.pose
    vehicle.state[0, :3] = pose.north, pose.east, pose.heading
    return vehicle


def how_far_off(run: Run) -> float:
    """Greatest distance [m] of the run from its own commands replayed."""
    simulated = replay(swamp(), run)
    return float(np.hypot(*(run.pose[:, :2] - simulated.pose[:, :2]).T).max())


def tell(vehicle: Vehicle, k: int, *texts: str) -> None:
    """Send commands to the module of thruster k, as the default recipient."""
    for text in texts:
        vehicle.receive(text.encode() + b"\0", vehicle.addresses.recipient, vehicle.addresses.modules[k])


def switched_on(conduct: Conduct | None = None, network: str = "127.0.0.0/24") -> Vehicle:
    """As `vehicle_of`, its motors running at references of 0."""
    vehicle = vehicle_of(conduct, network)
    for k in range(len(vehicle.modules)):
        tell(vehicle, k, *START)
    return vehicle


def own_network() -> Addresses:
    """A loopback network that no other process of this machine is likely to use."""
    number = os.getpid() % 60000 + 300
    return addresses(f"127.{number // 256 + 1}.{number % 256}.0/24", 4)


@contextmanager
def served(vehicle: Vehicle, speed: float = 10.0) -> Iterator[Vehicle]:
    """The vehicle answers on its endpoints within the block, `speed` times as fast as the clock."""
    begin, ended = time.monotonic(), threading.Event()

    def clock() -> float:
        return begin + speed * (time.monotonic() - begin)

    with endpoints(vehicle) as sockets:
        vehicle.advance(0.2)  # compiled before the clock begins to count
        thread = threading.Thread(
            target=serve, args=(vehicle, sockets), kwargs={"clock": clock, "ended": ended.is_set}
        )
        thread.start()
        try:
            yield vehicle
        finally:
            ended.set()
            thread.join(timeout=10.0)
