"""Frames a second that the driver gets while so many silent connections are held open to the recorder.

python -m benchmarks.attack server [--count 1200]
"""

import resource
import socket
import threading
import time
from argparse import Namespace
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

from websockets.sync.client import ClientConnection, connect

from benchmarks.attack.counts import Count
from benchmarks.attack.recorder import recorder, write_course
from benchmarks.attack.syscalls import scratch

COUNT, ROUNDS, FRAMES = 1200, 5, 100
LEAST = 0.9
"Share of the frames without the connections that the driver gets beside them, at least."


def frames_a_second(page: ClientConnection) -> float:
    """Over FRAMES frames, those that were waiting to be read left out."""
    until = time.monotonic() + 0.2
    while time.monotonic() < until:
        page.recv()
    begun = time.monotonic()
    for _ in range(FRAMES):
        page.recv()
    return FRAMES / (time.monotonic() - begun)


def measured(count: int) -> Count:
    """Frames a second without and with the connections, each the best of ROUNDS, taken in turn."""
    from swamp_rl.teleop.guard import Guard
    from swamp_rl.teleop.hub import Hub
    from swamp_rl.teleop.server import bound, server_of

    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (2 * count + 512, hard))
    with scratch() as root:
        write_course(root)
        session = recorder(Path(root))
        listening = bound("127.0.0.1", 0)
        place = listening.getsockname()
        server = server_of(Hub(session, "scripted"), Guard("127.0.0.1", None))
        serving = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
        serving.start()
        host = f"127.0.0.1:{place[1]}"
        alone, beside = [], []
        try:
            with connect(f"ws://{host}/socket", origin=f"http://{host}") as page:  # type: ignore[arg-type]
                for _ in range(ROUNDS):
                    alone.append(frames_a_second(page))
                    with ExitStack() as stack:
                        for _ in range(count):
                            stack.enter_context(closing(socket.create_connection(place)))
                        beside.append(frames_a_second(page))
        finally:
            server.should_exit = True
            serving.join()
            session.close()
    slow = max(beside) < LEAST * max(alone)
    found = f"{max(alone):.1f} frames a second without, {max(beside):.1f} with"
    return Count("server", f"{count:,} silent connections", ROUNDS, [found] if slow else [], found)


def attack(asked: Namespace) -> Iterator[Count]:
    """Counts of rounds, unexplained where the driver gets fewer frames."""
    yield measured(asked.count or COUNT)
