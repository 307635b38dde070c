"""Those who are connected: one drives, the others watch, and all see the same boat."""

import asyncio
import json
import logging
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from swamp_rl.errors import UserError
from swamp_rl.teleop import view
from swamp_rl.teleop.allowance import Allowance
from swamp_rl.teleop.messages import Choose, Command, Message, parse
from swamp_rl.teleop.session import SAVING, Session

PAUSE = 0.2  # s until a clock that stopped is started again
STILL = 5.0  # s that the clock may stand still before the page reports it
FRAME = 0.02  # s between two frames: 50 a second, and one more whenever the levers move
RATE, BURST = 150.0, 300.0  # messages a second that a connection may send; a page sends at most 80
PATIENCE = 2000  # messages beyond that, until the connection is closed
CROWD = 64  # connections
SILENCE = 10.0  # s without a command, after which another may take the seat
REFUSED = 1008

log = logging.getLogger("swamp_rl.teleop")


@dataclass(eq=False)
class Client:
    """A connected page: frames that it is too slow for are skipped, news are not."""

    number: int
    allowance: Allowance = field(default_factory=lambda: Allowance(RATE, BURST))
    news: deque[str] = field(default_factory=lambda: deque(maxlen=32))
    frame: str | None = None
    wake: asyncio.Event = field(default_factory=asyncio.Event)
    excess: int = 0

    def tell(self, message: dict[str, Any]) -> None:
        """Have a message sent."""
        self.news.append(json.dumps(message, allow_nan=False))
        self.wake.set()


class Hub:
    """Keeps the clock, hands messages to the session and frames to the pages. All in one event loop."""

    def __init__(self, session: Session, source: str, clock: Callable[[], float] = time.monotonic) -> None:
        """clock: of the boat [s], real time unless a test has its own."""
        self.session, self.source, self._clock = session, source, clock
        self.clients: list[Client] = []
        self.driver: Client | None = None
        self._commanded, self._announced_free = -SILENCE, True
        self._numbers = 0
        self._origin, self.beat = clock(), time.monotonic()

    def now(self) -> float:
        """The clock [s]."""
        return self._clock() - self._origin

    async def watch_the_clock(self) -> None:
        """Keep time until cancelled; whatever stops the clock, it is started again, the boat at a start."""
        while True:
            try:
                await self.keep_time()
            except Exception as error:
                log.critical("the clock stopped and is started again", exc_info=error)
                with suppress(Exception):
                    self.session.abandon()
                    self.say(None, f"The recorder had to begin anew: {error}")
                    self.publish()
            await asyncio.sleep(PAUSE)

    async def keep_time(self) -> None:
        """Advance the boat and send frames until cancelled."""
        due = time.monotonic()
        while True:
            self.show()
            due = max(due + FRAME, time.monotonic() - FRAME)
            await asyncio.sleep(max(due - time.monotonic(), 0.0))

    def show(self) -> None:
        """Advance the boat to the present and give everyone a frame of it."""
        self.beat = time.monotonic()
        now = self.now()
        phase = self.session.phase
        self.session.advance(now)
        complaint = self.session.complaint()
        if complaint is not None:
            log.error("%s", complaint)
            self.say(None, complaint)
        if self.clients:
            text = view.frame(self.session, now)
            for client in self.clients:
                client.frame = text
                client.wake.set()
        if self.session.listen() or self.session.phase != phase or self.seat_is_free != self._announced_free:
            self.publish()

    # --- connections ---

    async def talk(self, socket: WebSocket) -> None:
        """Serve one connection, from its acceptance to its end."""
        if len(self.clients) >= CROWD:
            await socket.close(REFUSED)
            return
        await socket.accept()
        self._numbers += 1
        client = Client(self._numbers)
        self.clients.append(client)
        if self.driver is None:
            self._seat(client)
        client.tell(view.scene(self.session, self.source))
        self.publish()
        sender = asyncio.create_task(self._send(client, socket))
        try:
            while await self._hear(client, socket):
                pass
        finally:
            sender.cancel()
            self._part(client)

    async def _send(self, client: Client, socket: WebSocket) -> None:
        while True:
            await client.wake.wait()
            client.wake.clear()
            while client.news:
                await socket.send_text(client.news.popleft())
            if client.frame is not None:
                text, client.frame = client.frame, None
                await socket.send_text(text)

    async def _hear(self, client: Client, socket: WebSocket) -> bool:
        """Take one message; False when the connection is over."""
        try:
            received = await socket.receive()
        except (WebSocketDisconnect, RuntimeError):
            return False
        if received["type"] == "websocket.disconnect":
            return False
        if not client.allowance.spend(time.monotonic()):
            client.excess += 1
            if client.excess == 1:
                log.error("connection %d sends too much; some of it is dropped", client.number)
            if client.excess > PATIENCE:
                await socket.close(REFUSED)
                return False
            return True
        try:
            await self._obey(client, parse(received.get("text") or received.get("bytes") or ""))
        except UserError as error:
            log.warning("connection %d: refused: %s", client.number, error)
            self.say(client, str(error))
        return True

    def _part(self, client: Client) -> None:
        self.clients.remove(client)
        if self.driver is client:
            self.driver = None
            self.session.lose()
        self.publish()

    # --- messages ---

    async def _obey(self, client: Client, message: Message) -> None:
        if not isinstance(message, Command | Choose) and message.act == "seat":
            self._change_seat(client)
            return
        if client is not self.driver:
            raise UserError("you are watching; take the seat to drive")
        if isinstance(message, Command):
            self._commanded = time.monotonic()
            before = self.session.levers
            self.session.command(message, self.now())
            if self.session.levers != before:
                self.show()
            return
        if isinstance(message, Choose):
            vessel = self.session.vessel
            self.session.choose(message)
            if self.session.vessel != vessel:
                self.tell(None, view.scene(self.session, self.source))
        elif message.act == "accept":
            await self._accept()
        elif message.act == "helm":
            self.session.change_helm(self.now())
        else:
            self.session.drop(again=message.act == "retry")
        self.publish()

    def _change_seat(self, client: Client) -> None:
        if client is self.driver:
            self.driver = None
        elif self.seat_is_free:
            self._seat(client)
        else:
            raise UserError("someone is driving; wait until the seat is free")
        self.session.lose()
        self.publish()

    @property
    def seat_is_free(self) -> bool:
        """Whether one who watches may take it: nobody drives, or whoever does has long sent no command."""
        return self.driver is None or time.monotonic() - self._commanded > SILENCE

    def _seat(self, client: Client) -> None:
        self.driver, self._commanded = client, time.monotonic()

    async def _accept(self) -> None:
        save = self.session.accept()
        assert self.session.phase == SAVING
        try:
            name = await asyncio.to_thread(save)
        except BaseException:
            self.session.not_accepted()
            raise
        self.session.accepted()
        self.tell(None, {"type": "accepted", "name": name})

    def publish(self) -> None:
        """Tell everyone how things stand."""
        self._announced_free = self.seat_is_free
        stands = view.status(self.session) | {
            "watchers": len(self.clients) - (self.driver is not None),
            "seat_taken": not self._announced_free,
        }
        for client in self.clients:
            client.tell({**stands, "driving": client is self.driver})

    def say(self, client: Client | None, text: str) -> None:
        """Show a line to one, or to everyone."""
        self.tell(client, {"type": "say", "text": text})

    def tell(self, client: Client | None, message: dict[str, Any]) -> None:
        """A message to one, or to everyone."""
        for other in self.clients if client is None else [client]:
            other.tell(message)
