"""The recorder's web server: a page, its socket, and the stored runs, for those whom the guard lets in."""

import asyncio
import contextlib
import errno
import logging
import signal
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from pathlib import Path
from types import FrameType

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from swamp_rl.errors import UserError
from swamp_rl.files import os_error
from swamp_rl.teleop import view
from swamp_rl.teleop.connections import PING, BoundedProtocol, BoundedSocket, Sparing
from swamp_rl.teleop.guard import COOKIE, LOCKED, Guard, is_loopback
from swamp_rl.teleop.heartbeat import heartbeat
from swamp_rl.teleop.hub import REFUSED, STILL, Hub, log

PAGE = Path(__file__).parent / "page"
LARGEST_FRAME = 16 * 1024  # bytes; what is larger ends the connection before it is read
MESSAGES = {
    400: "Malformed: a token has letters and digits only.",
    403: "Not allowed: open the address that swamp-rl record printed.",
    429: f"Too many wrong tokens: wait {LOCKED:g} s, then open the address that swamp-rl record printed.",
}
HEADERS = {
    "content-security-policy": "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'none'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cache-control": "no-cache",
}


class Gate:
    """Turns away, before anything else, whom the guard objects to, and adds headers to all answers."""

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self.app, self.guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """As ASGI has it."""
        objection = self.guard.objection(scope)
        if objection is None:
            await self.app(scope, receive, _with_headers(send))
            return
        log.warning("refused a connection: %s", objection.reason)
        if scope["type"] == "websocket":
            await WebSocket(scope, receive, send).close(REFUSED)
        else:
            answer = PlainTextResponse(f"{MESSAGES[objection.status]}\n", objection.status)
            await answer(scope, receive, _with_headers(send))


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = [(key.encode(), value.encode()) for key, value in HEADERS.items()]
            message = {**message, "headers": [*message["headers"], *headers]}
        await send(message)

    return sending


def application(hub: Hub, guard: Guard) -> ASGIApp:
    """The ASGI application; while it lives, the hub keeps time."""

    @contextlib.asynccontextmanager
    async def living(_: Starlette) -> AsyncIterator[None]:
        ticking = asyncio.create_task(hub.watch_the_clock())
        logs = [(logger, Sparing()) for logger in (log, logging.getLogger("uvicorn.error"))]
        for logger, spare in logs:
            logger.addFilter(spare)
        try:
            with heartbeat(lambda: hub.beat, STILL):
                yield
        finally:
            ticking.cancel()
            for logger, spare in logs:
                logger.removeFilter(spare)

    def front(request: Request) -> Response:
        if guard.in_query(request.scope):
            # The token goes into a cookie, out of the address that is shown and kept.
            answer = RedirectResponse("/", 303)
            if guard.token is not None:  # and not the query's, which may be wrong beside a right cookie
                answer.set_cookie(COOKIE, guard.token, httponly=True, samesite="strict")
            return answer
        return Response((PAGE / "index.html").read_bytes(), media_type="text/html")

    def stored(request: Request) -> Response:
        try:
            run = hub.session.recordings.read(request.path_params["name"])
            return JSONResponse(view.replayed(run, hub.session))
        except OSError as error:
            return JSONResponse({"error": str(os_error(error, request.path_params["name"]))}, 404)
        except UserError as error:
            return JSONResponse({"error": str(error)}, 404)

    routes = [
        Route("/", front),
        Route("/runs/{name}", stored),
        WebSocketRoute("/socket", hub.talk),
        Mount("/", StaticFiles(directory=PAGE)),
    ]
    return Gate(Starlette(routes=routes, lifespan=living), guard)


def bound(host: str, port: int) -> socket.socket:
    """A socket that listens there, port 0 being any free one; UserError where it cannot."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # Said to be TCP, asyncio sends small frames at once; otherwise they wait up to 40 ms for each other.
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
        listening.listen()
    except OSError as error:
        listening.close()
        if error.errno == errno.EADDRINUSE:
            raise UserError(f"--port {port}: already in use; name another, or 0 for any free one") from error
        raise os_error(error, f"--host {host} --port {port}") from error
    return listening


def address_of(listening: socket.socket, token: str | None) -> str:
    """What to open in a browser: on this machine's name, if every address of it is served."""
    host, port = listening.getsockname()[:2]
    if host in ("0.0.0.0", "::"):
        host = socket.gethostname()
    elif is_loopback(host) and ":" not in host:
        host = "127.0.0.1"
    host = f"[{host}]" if ":" in host else host
    return f"http://{host}:{port}/" + (f"?token={token}" if token else "")


class OrderlyServer(uvicorn.Server):
    """A server that a second Ctrl-C does not break off: it ends within a second as it is.

    A closed terminal (SIGHUP) ends it in order too, where that is heeded.
    """

    def run(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's own; a signal before its loop runs ends it in order too."""
        with self.capture_signals():
            super().run(sockets)

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """As uvicorn's own, with SIGHUP."""
        with super().capture_signals():
            before = signal.getsignal(signal.SIGHUP)
            main = threading.current_thread() is threading.main_thread()
            if main and callable(before):
                signal.signal(signal.SIGHUP, self.handle_exit)
            try:
                yield
            finally:
                if main and callable(before):
                    signal.signal(signal.SIGHUP, before)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """End in order; what comes after the first signal is nothing new."""
        if not self.should_exit:
            super().handle_exit(sig, frame)


def server_of(hub: Hub, guard: Guard) -> uvicorn.Server:
    """The server, to be run on a socket from `bound`."""
    config = uvicorn.Config(
        application(hub, guard),
        log_level="warning",
        ws=BoundedSocket,
        ws_max_size=LARGEST_FRAME,
        ws_per_message_deflate=False,
        ws_ping_interval=PING,
        ws_ping_timeout=PING,
        http=BoundedProtocol,
        proxy_headers=False,
        server_header=False,
        timeout_graceful_shutdown=1,
    )
    return OrderlyServer(config)


def serve(hub: Hub, guard: Guard, listening: socket.socket, ready: Callable[[str], None]) -> None:
    """Serve on a socket from `bound` until interrupted; `ready` is called with the address to open."""
    ready(address_of(listening, guard.token))
    server_of(hub, guard).run(sockets=[listening])
