"""A recorder that serves from a thread, as the browser's and the safety tests need one."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from swamp_rl.pilots.pilot import Pilot
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.guard import Guard
from swamp_rl.teleop.hub import Hub
from swamp_rl.teleop.lookout import Lookout
from swamp_rl.teleop.server import address_of, bound, server_of
from swamp_rl.teleop.session import DEAD_MAN, Session
from tests.support.driving import berth
from tests.support.patience import PATIENCE, until


@contextmanager
def serving(
    folder: Path,
    *,
    factor: float = 1.0,
    host: str = "127.0.0.1",
    token: str | None = None,
    level: str = "calm",
    course: str = "camogli",
    pilots: dict[str, Pilot] | None = None,
    boats: dict[str, Berth] | None = None,
    seed: int = 1,
    lookout: Lookout | None = None,
) -> Iterator[tuple[str, Hub]]:
    """The address and the hub; factor: how much faster than real time the boat's clock runs; boats: beside
    the SWAMP."""
    berths = {"swamp": berth(folder, level, course), **(boats or {})}
    session = Session(
        berths, np.random.default_rng(seed), pilots, dead_man=DEAD_MAN * factor, lookout=lookout
    )
    session.warm()
    hub = Hub(session, "scripted", factor)
    listening = bound(host, 0)
    server = server_of(hub, Guard(host, token))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        until(lambda: server.started or not thread.is_alive(), "the server starts")
        yield address_of(listening, token), hub
    finally:
        server.should_exit = True
        thread.join(PATIENCE)
        session.close()


GREAT_HASTE = 15.0  # for pilots, who need no browser
