"""A recorder that serves from a thread, as the browser's and the safety tests need one."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.pilots.pilot import Pilot
from swamp_rl.teleop import hub as hubs
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.guard import Guard
from swamp_rl.teleop.hub import Hub
from swamp_rl.teleop.lookout import Lookout
from swamp_rl.teleop.messages import Command
from swamp_rl.teleop.server import address_of, bound, server_of
from swamp_rl.teleop.session import DEAD_MAN, RUN, Session
from tests.support.driving import berth
from tests.support.patience import PATIENCE, until

STEP = 0.2  # s of the boat's clock, fewer than the dead-man waits for
FRAME = 0.01  # s between two frames that a command is waited for with


class Stepped(Session):
    """A session with a clock of its own, which each command of a run moves on by `STEP` and nothing else.

    So the boat waits for whoever drives it, however busy the machine.
    """

    clock = 0.0

    def command(self, message: Command, now: float) -> None:
        under_way = self.phase == RUN
        super().command(message, now)
        self.clock += STEP if under_way else 0.0


@contextmanager
def serving(
    folder: Path,
    *,
    factor: float | None = 1.0,
    host: str = "127.0.0.1",
    token: str | None = None,
    level: str = "calm",
    course: str = "camogli",
    pilots: dict[str, Pilot] | None = None,
    boats: dict[str, Berth] | None = None,
    seed: int = 1,
    lookout: Lookout | None = None,
) -> Iterator[tuple[str, Hub]]:
    """The address and the hub; factor: how much faster than real time the boat's clock runs, None where the
    commands move it on (`Stepped`); boats: beside the SWAMP."""
    patch = pytest.MonkeyPatch()
    berths, seeds = {"swamp": berth(folder, level, course), **(boats or {})}, np.random.default_rng(seed)
    if factor is None:
        session = stepped = Stepped(berths, seeds, pilots, lookout=lookout)
        hub = Hub(session, "scripted", lambda: stepped.clock)
        patch.setattr(hubs, "FRAME", FRAME)
    else:
        session = Session(berths, seeds, pilots, dead_man=DEAD_MAN * factor, lookout=lookout)
        hub = Hub(session, "scripted", lambda: factor * time.monotonic())
    session.warm()
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
        patch.undo()


GREAT_HASTE = 15.0  # for pilots, who need no browser
