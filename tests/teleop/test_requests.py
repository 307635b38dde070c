"""Requests that are malformed for HTTP or for a WebSocket: each is refused and its connection ended."""

import json
import socket
from collections.abc import Iterator
from contextlib import suppress

import pytest

from swamp_rl.teleop import connections
from swamp_rl.teleop.guard import Guard
from tests.support.patience import PATIENCE
from tests.support.recorder import serving
from tests.support.web import driving, hear, place

pytestmark = pytest.mark.timed

COMMAND = {"type": "command", "throttle": 0.5, "angle": 0.1}
POST = "POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n"
GET = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
MALFORMED = {
    "a chunk of no size": f"{POST}\r\nx\r\n",
    "a negative chunk": f"{POST}\r\n-3\r\nabc\r\n0\r\n\r\n",
    "a huge chunk": f"{POST}\r\n{'F' * 30}\r\nabc",
    "an extension over two lines": f'{POST}\r\n3;a="\r\n"\r\nabc\r\n0\r\n\r\n',
    "trailers without end": f"{POST}\r\n0\r\n" + "X: y\r\n" * 20_000,
    "two lengths": f"{GET}Content-Length: 0\r\nContent-Length: 9\r\n\r\n",
    "a length with a sign": f"{GET}Content-Length: +5\r\n\r\nabcde",
    "an unknown encoding": f"{GET}Transfer-Encoding: xchunked\r\n\r\n0\r\n\r\n",
    "a space before the colon": f"{GET}Transfer-Encoding : chunked\r\n\r\n0\r\n\r\n",
    "two hosts": f"{GET}Host: evil.example\r\n\r\n",
    "a bare line feed": "GET / HTTP/1.1\r\nHost: evil.example\nHost: 127.0.0.1\r\n\r\n",
    "another protocol": "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
}


@pytest.fixture(scope="module")
def recorder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with serving(tmp_path_factory.mktemp("recorder") / "runs") as (address, _):
        yield address


def response(address: str, *parts: str) -> bytes:
    """All that is answered until the connection is closed; each part waits for an answer to the one before.

    TimeoutError where it is not closed.
    """
    with socket.create_connection(place(address), timeout=PATIENCE) as asked:
        answers = b""
        for number, part in enumerate(parts):
            if number:
                answers += asked.recv(65536)
            with suppress(ConnectionResetError, BrokenPipeError):
                asked.sendall(part.encode("latin-1"))
        with suppress(ConnectionResetError):
            while more := asked.recv(65536):
                answers += more
    return answers


@pytest.mark.parametrize("request_", MALFORMED.values(), ids=MALFORMED)
def test_a_malformed_request_is_refused_and_ended_without_a_traceback(
    recorder: str, request_: str, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    answered = response(recorder, request_)
    assert b" 200 " not in answered and (b" 400 " in answered or b" 403 " in answered or not answered)
    assert "Traceback" not in capfd.readouterr().err + caplog.text


def test_a_body_that_is_malformed_after_its_answer_ends_the_connection_without_a_traceback(
    recorder: str, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    answered = response(recorder, f"{POST}\r\n", "-3\r\nabc\r\n")
    assert answered.count(b"HTTP/1.1 ") == 1 and b" 405 " in answered
    assert "Traceback" not in capfd.readouterr().err + caplog.text


def upgrade(address: str, more: str = "", path: str = "/socket") -> str:
    """What a page asks for its socket, with more header lines."""
    host = address.split("/")[2]
    return (
        f"GET {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\n"
        "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        f"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{more}\r\n"
    )


UNREADABLE = {
    "a body": ("Content-Length: 5\r\n", "/socket"),
    "a chunked body": ("Transfer-Encoding: chunked\r\n", "/socket"),
    "130 headers": ("".join(f"X{number}: y\r\n" for number in range(130)), "/socket"),
    "a long header": (f"X: {'y' * 9000}\r\n", "/socket"),
    "a long path": ("", f"/socket?{'a' * 9000}"),
}


@pytest.mark.parametrize(("more", "path"), UNREADABLE.values(), ids=UNREADABLE)
def test_an_upgrade_that_the_library_of_sockets_does_not_read_is_refused_and_ended(
    recorder: str, more: str, path: str
) -> None:
    # It was neither answered nor ended, and 256 of them kept everybody out.
    assert response(recorder, upgrade(recorder, more, path)).startswith(b"HTTP/1.1 400 ")


FLOODS = {
    "empty fragments": b"\x01\x80\0\0\0\0" + b"\x00\x80\0\0\0\0" * 2000,
    "pings": b"\x89\x80\0\0\0\0" * 2000,
    "messages": b"\x81\x82\0\0\0\0{}" * 2000,
}


@pytest.mark.parametrize("flood", FLOODS.values(), ids=FLOODS)
def test_a_socket_that_sends_too_many_bytes_is_ended_whatever_its_frames(
    recorder: str, flood: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "BYTES", 8000.0)
    monkeypatch.setattr(connections, "MORE_BYTES", 100.0)
    with driving(recorder) as driver:
        assert response(recorder, upgrade(recorder), flood.decode("latin-1")).startswith(b"HTTP/1.1 101 ")
        driver.send(json.dumps(COMMAND))
        hear(driver, lambda message: message.get("levers") == [0.5, 0.1])


@pytest.mark.parametrize(
    "twice",
    [
        [(b"origin", b"http://127.0.0.1:8000"), (b"origin", b"http://evil.example")],
        [(b"sec-fetch-site", b"none"), (b"sec-fetch-site", b"cross-site")],
    ],
)
def test_a_header_that_is_given_twice_is_not_taken_for_none(twice: list[tuple[bytes, bytes]]) -> None:
    scope = {"type": "http", "headers": [(b"host", b"127.0.0.1:8000"), *twice]}
    refused = Guard("127.0.0.1", None).objection(scope)
    assert refused is not None and refused.reason == "its origin is another page"
