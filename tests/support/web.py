"""Requests and sockets of browsers, and of strangers, to a recorder's server."""

import json
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from websockets.sync.client import ClientConnection, connect

from tests.support.patience import PATIENCE


def place(address: str) -> tuple[str, int]:
    host, port = address.split("/")[2].split(":")
    return host, int(port)


@contextmanager
def driving(address: str, **headers: str) -> Iterator[ClientConnection]:
    host = address.split("/")[2]
    with connect(f"ws://{host}/socket", origin=f"http://{host}", additional_headers=headers) as page:  # type: ignore[arg-type]
        yield page


def hear(page: ClientConnection, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        message = json.loads(page.recv(timeout=PATIENCE))
        if wanted(message):
            return message
    raise AssertionError("the message never came")


def answer(address: str, *lines: str) -> str:
    """What a request of these header lines gets; nothing if the connection is closed without a word."""
    with socket.create_connection(place(address), timeout=PATIENCE) as asked:
        asked.sendall("".join(f"{line}\r\n" for line in (*lines, "Connection: close", "")).encode("latin-1"))
        return b"".join(iter(lambda: asked.recv(65536), b"")).decode("latin-1")


def status(address: str, path: str = "/", host: str | None = None, *lines: str) -> int:
    host = address.split("/")[2] if host is None else host
    return int(answer(address, f"GET {path} HTTP/1.1", f"Host: {host}", *lines).split()[1])
