"""Connections that cost the driver nothing: silent ones, too many, wrong tokens; and a clock that dies."""

import json
import logging
import resource
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection

from swamp_rl.runs import read_dataset
from swamp_rl.teleop import connections, server, view
from tests.support.driving import recordings
from tests.support.patience import PATIENCE
from tests.support.recorder import serving
from tests.support.web import driving, hear, place, status

pytestmark = pytest.mark.timed

TOKEN = "harbour7"
MANY = 1200
ROUNDS = 3  # that are compared, so that an hour of quiet before counts no more
COMMAND = {"type": "command", "throttle": 0.5, "angle": 0.1}


def is_closed(silent: socket.socket) -> bool:
    """Whether the other end closes it within the patience; what it says before is skipped."""
    silent.settimeout(PATIENCE)
    try:
        while silent.recv(65536):
            pass
    except ConnectionResetError:
        return True
    except TimeoutError:
        return False
    return True


@pytest.mark.parametrize("result", [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: "])
def test_a_connection_without_whole_headers_is_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: bytes
) -> None:
    monkeypatch.setattr(connections, "SILENT", 0.3)
    with serving(tmp_path / "runs") as (address, _), socket.create_connection(place(address)) as silent:
        silent.sendall(result)
        assert is_closed(silent)


def test_a_connection_that_keeps_itself_busy_ends_nevertheless(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "SILENT", 0.3)
    monkeypatch.setattr(connections, "LONGEST", 1.0)
    with serving(tmp_path / "runs") as (address, _), socket.create_connection(place(address)) as busy:
        until, ended = time.monotonic() + PATIENCE, False
        busy.sendall(b"GET /main.js HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\nGET / HTTP/1.1\r\n")
        busy.settimeout(0.1)
        while not ended and time.monotonic() < until:
            try:
                busy.sendall(b"X: y\r\n")
                ended = busy.recv(65536) == b""
            except TimeoutError:
                continue
            except OSError:
                ended = True
        assert ended


def test_a_page_that_answers_no_ping_is_closed_and_one_that_does_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("swamp_rl.teleop.server.PING", 0.5)
    with (
        serving(tmp_path / "runs") as (address, _),
        driving(address) as page,
        socket.create_connection(place(address)) as silent,
    ):
        silent.sendall(upgrade(address))
        hear(page, lambda message: message.get("watchers") == 1)
        hear(page, lambda message: message.get("watchers") == 0)
        assert is_closed(silent)
        page.send(json.dumps(COMMAND))
        hear(page, lambda message: message.get("levers") == [0.5, 0.1])


FRAMES = {
    "text that is none": b"\x81\x82\0\0\0\0\xff\xfe",
    "no mask": b"\x81\x02{}",
    "a reserved bit": b"\xc1\x82\0\0\0\0{}",
    "a reserved kind": b"\x85\x81\0\0\0\0x",
    "a length of 2^62 bytes": b"\x81\xff\x40" + bytes(7) + bytes(4),
    "a fragment of nothing": b"\x80\x81\0\0\0\0x",
    "fragments without end": b"\x01\xfe\x03\xe8" + bytes(1004) + (b"\x00\xfe\x03\xe8" + bytes(1004)) * 40,
    "a long ping": b"\x89\xfe\x00\x7e" + bytes(4 + 126),
    "a close without its code": b"\x88\x81\0\0\0\0x",
}


@pytest.mark.parametrize("frame", FRAMES)
def test_a_frame_that_is_none_ends_its_own_connection_in_a_line_and_no_other(
    tmp_path: Path, frame: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with (
        serving(tmp_path / "runs") as (address, _),
        driving(address) as driver,
        socket.create_connection(place(address)) as bad,
    ):
        bad.sendall(upgrade(address))
        hear(driver, lambda message: message.get("watchers") == 1)
        with suppress(OSError):  # it may be closed before all is sent
            bad.sendall(FRAMES[frame])
        assert is_closed(bad)
        hear(driver, lambda message: message.get("watchers") == 0)
        driver.send(json.dumps(COMMAND))
        hear(driver, lambda message: message.get("levers") == [0.5, 0.1])
    assert "Traceback" not in capfd.readouterr().err


def upgrade(address: str) -> bytes:
    """What a page asks for its socket."""
    host = address.split("/")[2]
    lines = ["GET /socket HTTP/1.1", f"Host: {host}", f"Origin: http://{host}", "Connection: Upgrade"]
    lines += ["Upgrade: websocket", "Sec-WebSocket-Version: 13"]
    lines += ["Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==", "", ""]
    return "\r\n".join(lines).encode()


def test_of_too_many_silent_connections_the_oldest_makes_room_for_a_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "MOST", 8)
    with serving(tmp_path / "runs") as (address, _), driving(address) as driver, ExitStack() as stack:
        silent = [stack.enter_context(socket.create_connection(place(address))) for _ in range(40)]
        assert all(is_closed(one) for one in silent[:32])
        assert status(address) == 200
        with driving(address) as watcher:
            hear(watcher, lambda message: message["type"] == "scene")
        hear(driver, lambda message: message["type"] == "frame")


def test_strangers_with_whole_requests_do_not_keep_a_page_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "MOST", 8)
    with serving(tmp_path / "runs") as (address, _), driving(address) as driver, ExitStack() as stack:
        held = [stack.enter_context(socket.create_connection(place(address))) for _ in range(7)]
        for one in held:
            one.sendall(b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 9\r\n\r\nhalf")
            assert one.recv(65536)
        assert status(address) == 200
        with driving(address) as watcher:
            hear(watcher, lambda message: message["type"] == "scene")
        hear(driver, lambda message: message["type"] == "frame")


@pytest.fixture
def many_files() -> Iterator[None]:
    """Room for both ends of MANY connections in this process."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 2 * MANY + 512
    if hard != resource.RLIM_INFINITY and hard < wanted:
        pytest.skip(f"a process may open {hard} files here, {wanted} are needed")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, wanted), hard))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.mark.usefixtures("many_files")
def test_1200_silent_connections_cost_the_driver_no_frames(tmp_path: Path) -> None:
    with serving(tmp_path / "runs") as (address, _), driving(address) as driver:
        hear(driver, lambda message: message.get("driving"))
        alone, beside, enough = [], [], False
        last = time.monotonic() + PATIENCE
        while not enough and time.monotonic() < last:  # other work costs some rounds frames
            alone.append(frames_a_second(driver))
            with ExitStack() as stack:
                for _ in range(MANY):
                    stack.enter_context(socket.create_connection(place(address), timeout=PATIENCE))
                beside.append(frames_a_second(driver))
            enough = max(beside[-ROUNDS:]) > 0.8 * max(alone[-ROUNDS:])
    assert enough


def frames_a_second(page: ClientConnection, wanted: int = 40) -> float:
    """Of frames as they are made, those that waited in the connection left out."""
    last = 0.0
    while time.monotonic() - last < 0.01 or last == 0.0:
        last = time.monotonic()
        hear(page, lambda message: message["type"] == "frame")
    begun = time.monotonic()
    for _ in range(wanted):
        hear(page, lambda message: message["type"] == "frame")
    return wanted / (time.monotonic() - begun)


def test_refused_connections_fill_no_log(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    tries, allowed = 0, 0.0
    with caplog.at_level(logging.WARNING), serving(tmp_path / "runs") as (address, _):
        begun = time.monotonic()
        while tries < 3 * connections.LINES or tries <= allowed + 1:  # however slow, more than the log takes
            assert status(address, host="evil.com") == 403
            tries += 1
            allowed = connections.LINES + connections.MORE_LINES * (time.monotonic() - begun)
        assert sum("refused a connection" in record.message for record in caplog.records) <= allowed + 1


def test_a_clock_that_dies_is_started_again_and_its_run_is_kept_as_unfinished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    broken, whole = threading.Event(), view.frame

    def frame(*words: Any) -> str:
        if broken.is_set():
            broken.clear()
            raise ZeroDivisionError("broken by a test")
        return whole(*words)

    monkeypatch.setattr(view, "frame", frame)
    with serving(tmp_path / "runs") as (address, _), driving(address) as driver:
        seen: dict[str, Any] = {}
        while seen.get("time", 0.0) < 0.5:
            driver.send(json.dumps(COMMAND))
            seen = hear(driver, lambda message: message["type"] == "frame")
        broken.set()
        hear(driver, lambda message: "broken by a test" in message.get("text", ""))
        hear(driver, lambda message: message.get("phase") == "ready")
        driver.send(json.dumps(COMMAND))
        hear(driver, lambda message: message.get("phase") == "run")
    assert "the clock stopped and is started again" in caplog.text
    recordings(tmp_path / "runs").close()
    names = {run.name for run in read_dataset(tmp_path / "runs").runs if run.meta.outcome == "interrupted"}
    assert "run-0001" in names


def test_a_clock_that_hangs_in_a_call_is_reported_with_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    hang, result, whole = threading.Event(), threading.Event(), view.frame

    def stuck(*words: Any) -> str:
        if hang.is_set():
            result.wait(PATIENCE)
            hang.clear()
        return whole(*words)

    class Listening(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if "has stood still" in record.getMessage():
                result.set()

    monkeypatch.setattr(view, "frame", stuck)
    monkeypatch.setattr(server, "STILL", 0.2)
    listening = Listening()
    logging.getLogger("swamp_rl.teleop").addHandler(listening)
    try:
        with serving(tmp_path / "runs") as (address, _), driving(address) as driver:
            hear(driver, lambda message: message["type"] == "frame")
            hang.set()
            assert result.wait(PATIENCE)
            hear(driver, lambda message: message["type"] == "frame")
    finally:
        logging.getLogger("swamp_rl.teleop").removeHandler(listening)
    assert "< stuck (" in caplog.text and "test_connections.py" in caplog.text
