"""Connections of the recorder's server: how many there are at most, and how long an idle one is kept."""

import asyncio
import logging
import time
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from swamp_rl.teleop.allowance import Allowance

MOST = 256
"""Connections. For another the oldest makes room that is no WebSocket: of the silent ones, and of all others
where none is silent, or strangers with whole requests would keep a page out."""
SILENT = 10.0  # s that a connection may take for the headers of its first request
LONGEST = 60.0  # s that a connection lasts that does not become a WebSocket
BYTES, MORE_BYTES = 2.0**18, 2.0**16
"""Bytes that a WebSocket may send at once, one read of asyncio, and a second; a page sends at most 16 kB a
second."""
PING = 20.0  # s between two pings of a WebSocket, and until it is closed that answers none
LINES, MORE_LINES = 50.0, 1.0  # of the log in a burst, and a second


class BoundedProtocol(H11Protocol):
    """HTTP on a connection that is aborted when it is silent, lasts too long, or is one too many."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """As asyncio has it."""
        super().connection_made(transport)
        self.begun = self.loop.time()
        self._end = self.loop.call_later(SILENT, self._end_if_silent)
        if len(self.connections) > MOST:
            others = [one for one in self.connections if isinstance(one, BoundedProtocol) and one is not self]
            silent = [one for one in others if one.silent]
            min(silent or others or [self], key=lambda one: one.begun).abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """As asyncio has it."""
        self._end.cancel()
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Hand the connection over to the WebSocket's protocol, whose pings end it.

        A request with a body, or with more or longer headers than the WebSocket's library reads, is refused:
        that protocol would neither answer nor end it.
        """
        self._end.cancel()
        super().handle_websocket_upgrade(event)
        if not self.transport.get_protocol().handshake_initiated:  # type: ignore[attr-defined]
            self.send_400_response("Invalid WebSocket request received.")

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP. If it is the body of a request, that gets no other answer."""
        if self.cycle is not None:
            self.cycle.disconnected = True
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            super().send_400_response(msg)
        else:
            self.transport.close()

    @property
    def silent(self) -> bool:
        """Whether it has not yet sent the headers of a request."""
        return self.headers is None

    def abort(self) -> None:
        """End the connection at once."""
        self._end.cancel()
        self.connections.discard(self)
        self.transport.abort()

    def _end_if_silent(self) -> None:
        if self.silent:
            self.abort()
        else:
            self._end = self.loop.call_later(LONGEST - SILENT, self.abort)


class BoundedSocket(WebSocketsSansIOProtocol):
    """A WebSocket that is aborted when it sends too many bytes, of whatever kind of frame."""

    def connection_made(self, transport: Any) -> None:
        """As asyncio has it."""
        super().connection_made(transport)
        self._allowance = Allowance(MORE_BYTES, BYTES)

    def data_received(self, data: bytes) -> None:
        """As asyncio has it; no byte beyond the allowance is parsed."""
        if self._allowance.spend(self.loop.time(), len(data)):
            super().data_received(data)
        else:
            self.transport.abort()


class Sparing(logging.Filter):
    """Lets so many lines into a log, errors apart from warnings; the next line says how many it kept out."""

    def __init__(self) -> None:
        super().__init__()
        self._allowances = {True: Allowance(MORE_LINES, LINES), False: Allowance(MORE_LINES, LINES)}
        self._kept_out = 0

    def filter(self, record: logging.LogRecord) -> bool:
        """As `logging` has it."""
        if record.exc_info and isinstance(record.exc_info[1], UnicodeDecodeError):
            record.exc_info = None  # a stranger's bytes, by uvicorn's WebSocket: they have no place here
        if not self._allowances[record.levelno >= logging.ERROR].spend(time.monotonic()):
            self._kept_out += 1
            return False
        if self._kept_out:
            record.msg, record.args = f"{record.getMessage()} ({self._kept_out} lines omitted)", ()
            self._kept_out = 0
        return True
