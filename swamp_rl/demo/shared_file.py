"""One file, served over HTTP to a page of this machine that knows its address."""

import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

HOST = "127.0.0.1"
IDLE = 30.0
"""A connection that says nothing for so long is closed, s."""


@contextmanager
def shared_file(path: Path, origin: str) -> Iterator[str]:
    """Serve a file to pages of an origin while the context lasts; its address.

    origin: the page's scheme, host and port; browsers keep the file from any other. The address holds 128
    random bits, so that other users of this machine cannot ask for it, and a `Host` that is not this server's
    is refused, so that no name that someone else points to this machine reaches it.
    """
    where = f"/{secrets.token_urlsafe(16)}/{path.name}"
    with _Server((HOST, 0), partial(_Handler, path, where, origin)) as server:
        serving = Thread(target=server.serve_forever, daemon=True)
        serving.start()
        try:
            yield f"http://{HOST}:{server.server_port}{where}"
        finally:
            server.shutdown()
            serving.join()


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A reader that closed its connection is not logged."""


class _Handler(BaseHTTPRequestHandler):
    timeout = IDLE
    server_version, sys_version = "swamp-rl", ""

    def __init__(self, path: Path, where: str, origin: str, *arguments: Any) -> None:
        self._file, self._where, self._origin = path, where, origin
        super().__init__(*arguments)

    def do_HEAD(self) -> None:
        self._answer(with_content=False)

    def do_GET(self) -> None:
        self._answer(with_content=True)

    def _answer(self, with_content: bool) -> None:
        own = f"{HOST}:{self.connection.getsockname()[1]}"
        if self.headers.get_all("Host") != [own]:
            self.send_error(403)
        elif not secrets.compare_digest(self.path.encode(), self._where.encode()):
            self.send_error(404)
        else:
            self._send(with_content)

    def _send(self, with_content: bool) -> None:
        with self._file.open("rb") as content, suppress(ConnectionError):
            self.send_response(200)
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Content-Length", str(self._file.stat().st_size))
            self.send_header("Access-Control-Allow-Origin", self._origin)
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            if with_content:
                shutil.copyfileobj(content, self.wfile)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Requests are not logged."""
