"""A disk that fills and a folder that vanishes: the page goes on, says what is wrong, and no run is lost."""

import errno
import json
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

from swamp_rl.errors import UserError
from swamp_rl.runs import check_dataset, read_dataset
from swamp_rl.teleop.rows import largest_difference
from tests.support.driving import BOAT, accept, aim, command, drive, recordings, session
from tests.support.patience import PATIENCE
from tests.support.recorder import serving

pytestmark = pytest.mark.timed

BETWEEN = 0.01  # s between two commands, as a page's


class Page:
    """A page's end of the socket: it drives as `driving.aim` does, and remembers the messages to it.

    It answers no frame of a run twice: each answer moves the boat's clock on.
    """

    def __init__(self, socket: ClientConnection) -> None:
        self.socket, self.messages, self.sent, self.answered = socket, list[str](), 0.0, ("", 0.0)

    def until(self, wanted: Callable[[dict[str, Any]], bool], throttle: float = 1.0) -> None:
        """Drive until a message is wanted."""
        last = time.monotonic() + PATIENCE
        while time.monotonic() < last:
            message = json.loads(self.socket.recv(timeout=PATIENCE))
            if message["type"] == "say":
                self.messages.append(message["text"])
            if message["type"] == "frame" and self.is_due(message):
                self.sent, self.answered = time.monotonic(), (message["phase"], message["time"])
                angle = aim(*message["pose"], message["velocity"][2], message["passed"])
                levers = {"type": "command", "throttle": throttle, "angle": angle}
                self.socket.send(json.dumps(levers))
            if wanted(message):
                return
        raise AssertionError(f"it never came; messages: {self.messages}")

    def is_due(self, frame: dict[str, Any]) -> bool:
        """Whether the frame is to be answered: a new one of a run, or any at the start."""
        phase = frame["phase"]
        asks = phase == "ready" or (phase == "run" and (phase, frame["time"]) != self.answered)
        return asks and time.monotonic() > self.sent + BETWEEN

    def act(self, name: str) -> None:
        self.socket.send(json.dumps({"type": "act", "act": name}))


@contextmanager
def driving(folder: Path, course: str = "camogli") -> Iterator[Page]:
    with serving(folder, factor=None, course=course) as (address, _):
        host = address.split("/")[2]
        with connect(f"ws://{host}/socket", origin=f"http://{host}", ping_interval=None) as socket:
            yield Page(socket)


@pytest.fixture
def short(tmp_path: Path) -> str:
    """A course whose runs end after 8 s."""
    (tmp_path / "short.yaml").write_text("extends: camogli\ntime_limit: 8.0\n")
    return str(tmp_path / "short.yaml")


def has_text(part: str) -> Callable[[dict[str, Any]], bool]:
    return lambda message: message["type"] == "say" and part in message["text"]


def phase(name: str) -> Callable[[dict[str, Any]], bool]:
    return lambda message: message.get("phase") == name


def refused(folder: Path) -> Callable[[dict[str, Any]], bool]:
    """An acceptance, not a message about a run under way."""
    return lambda message: has_text(str(folder))(message) and "accepting it" not in message["text"]


def sailed(seconds: float) -> Callable[[dict[str, Any]], bool]:
    return lambda message: message.get("phase") == "run" and message["time"] > seconds


def is_at_rest(message: dict[str, Any]) -> bool:
    return message.get("phase") == "ready" and message["levers"][0] == 0.0


def is_accepted(message: dict[str, Any]) -> bool:
    return message["type"] == "accepted"


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """While it is set, no file is flushed to the disk."""
    event, flush = threading.Event(), os.fsync

    def refused(file: int) -> None:
        if event.is_set():
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        flush(file)

    monkeypatch.setattr(os, "fsync", refused)
    return event


def test_a_disk_that_fills_in_a_run_is_reported_the_run_goes_on_and_is_accepted_once_there_is_room(
    tmp_path: Path, full: threading.Event
) -> None:
    with driving(tmp_path / "runs") as page:
        page.until(sailed(2.0))
        full.set()
        page.until(has_text("No space left on device"))
        page.until(phase("ended"))
        page.act("accept")
        page.until(lambda message: has_text("No space")(message) and "accepting it" not in message["text"])
        page.until(phase("ended"))
        full.clear()
        page.act("accept")
        page.until(is_accepted)
        assert len(page.messages) == 2
    (run,) = read_dataset(tmp_path / "runs").runs
    assert run.time[0] == 0.0 and run.meta.outcome != "interrupted"
    assert largest_difference(run, BOAT) == 0.0


def test_a_disk_that_is_full_before_a_run_is_reported_and_what_was_accepted_stays(
    tmp_path: Path, full: threading.Event, short: str
) -> None:
    with driving(tmp_path / "runs", short) as page:
        page.until(phase("ended"))
        page.act("accept")
        page.until(is_accepted)
        full.set()
        page.until(has_text("No space left on device"))
        page.until(phase("ended"))
        page.act("discard")
        page.until(is_at_rest, throttle=0.0)
        full.clear()
        page.until(phase("ended"))
        page.act("accept")
        page.until(is_accepted)
    assert check_dataset(tmp_path / "runs") == []
    assert len(read_dataset(tmp_path / "runs").runs) == 2


@pytest.mark.parametrize("under_way", [False, True])
def test_a_folder_that_vanishes_is_reported_and_when_it_is_back_runs_are_kept_again(
    tmp_path: Path, under_way: bool, short: str
) -> None:
    folder, away = tmp_path / "runs", tmp_path / "away"
    with driving(folder, short) as page:
        page.until(phase("ended"))
        page.act("accept")
        page.until(is_accepted)
        if under_way:
            page.until(sailed(1.0))
            folder.rename(away)
            page.until(phase("ended"))
            page.act("accept")
            page.until(refused(folder))
        else:
            folder.rename(away)
            page.until(has_text("cannot be recorded"))
            # A lever that is held does not begin it again and again.
            page.until(phase("ready"))
            assert len(page.messages) == 1
        assert not folder.exists()
        away.rename(folder)
        if not under_way:
            page.until(is_at_rest, throttle=0.0)
        page.until(phase("ended"))
        page.act("accept")
        page.until(is_accepted)
    assert check_dataset(folder) == []
    runs = read_dataset(folder).runs
    assert [run.name for run in runs] == ["run-0001", "run-0002"]
    assert all(largest_difference(run, BOAT) == 0.0 for run in runs)


def test_what_the_disk_refused_at_the_end_is_in_the_dataset_when_it_is_accepted(
    tmp_path: Path, full: threading.Event
) -> None:
    game = session(tmp_path / "runs")
    now = 0.0
    while game.boat.now.passed < 1:
        game.command(command(game), now)
        now += 0.04
    full.set()
    drive(game, now)
    assert game.journal is not None
    with pytest.raises(UserError):
        game.journal.sync()
    assert "No space left" in str(game.complaint()) and game.complaint() is None
    rows = game.rows
    full.clear()
    run = game.recordings.read(accept(game))
    assert len(run.time) == rows
    assert largest_difference(run, BOAT) == 0.0


def test_a_run_that_nothing_could_be_done_about_is_discarded_whatever_the_disk_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = session(tmp_path / "runs")
    drive(game)
    with monkeypatch.context() as patch:

        def refused(*_: object, **__: object) -> None:
            raise OSError(errno.EROFS, os.strerror(errno.EROFS))

        patch.setattr(os, "unlink", refused)
        patch.setattr(Path, "unlink", refused)
        game.drop(again=False)
    assert game.journal is None and game.phase == "ready"
    game.close()
    again = recordings(tmp_path / "runs")
    assert again.read("run-0001").meta.outcome == "interrupted"
