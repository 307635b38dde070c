"""Rerun's own viewer: in a window, or served to a browser of this machine only."""

import errno
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

from swamp_rl.demo.shared_file import HOST, shared_file
from swamp_rl.errors import UserError
from swamp_rl.workers.signals import held

RERUN = (sys.executable, "-P", "-m", "rerun_cli")
"""Its command alone, which starts without its Python library; no module of the working directory."""
NO_SERVER = f"rerun+http://{HOST}:9/proxy"
"""Nothing listens there: given an address to view, rerun serves its page alone. Its server of data, which it
would start otherwise, keeps a processor busy without end after a recording is read (rerun-io/rerun 10944)."""
PATIENCE = 30.0
"""How long rerun may take to listen, and to end, s."""


def has_display() -> bool:
    """Whether a window can be opened."""
    return sys.platform in ("darwin", "win32") or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY")))


def open_viewer(recording: Path) -> None:
    """Show a recording in a window, until it is closed; UserError where the viewer cannot start."""
    done = subprocess.run([*RERUN, str(recording), "--bind", HOST, "--port", "auto"])
    if done.returncode:
        raise UserError("rerun's viewer could not be started; --web shows the same in a browser")


def serve(recording: Path, port: int | None, ready: Callable[[str], None]) -> None:
    """Serve rerun's web viewer with a recording on this machine's own address until interrupted.

    port: of the page; any free one by default. ready: hears the page's address once it is served. UserError
    where the port is taken or rerun does not start.
    """
    port = free_port(port)
    asked = [*RERUN, NO_SERVER, "--serve-web", "--bind", HOST]
    asked += ["--web-viewer-port", str(port), "--hide-welcome-screen"]
    server = None
    try:
        with held():  # an interrupt meanwhile would leave a server that nobody knows
            # In a group of its own, as rerun's Python command starts the server as a process of its own.
            server = subprocess.Popen(
                asked, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
            )
        _wait_for(server, port)
        page = f"http://{HOST}:{port}"
        with shared_file(recording, page) as where:
            ready(f"{page}/?url={quote(where, safe='')}")
            server.communicate()
    finally:
        if server is not None:
            _end(server)


def _end(server: subprocess.Popen[str]) -> None:
    """End the server and what it has started."""
    if server.poll() is None:
        os.killpg(server.pid, signal.SIGTERM)
        try:
            server.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(server.pid, signal.SIGKILL)
            server.wait()


def free_port(asked: int | None) -> int:
    """`asked`, or any, if nothing listens there; UserError otherwise."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, asked or 0))
        except (OSError, OverflowError) as error:
            taken = getattr(error, "errno", None) == errno.EADDRINUSE
            reason = "already in use" if taken else getattr(error, "strerror", None) or str(error)
            raise UserError(f"--port {asked}: {reason}; name another, or none for any free one") from error
        return int(probe.getsockname()[1])


def _wait_for(server: subprocess.Popen[str], port: int) -> None:
    until = time.monotonic() + PATIENCE
    while True:
        if server.poll() is not None:
            output = (server.communicate()[0] or "").strip().splitlines()
            raise UserError(f"rerun's server exited at once: {output[-1] if output else 'no message'}")
        if time.monotonic() > until:
            raise UserError(f"rerun's server did not listen within {PATIENCE:g} s; try again, or --save")
        with socket.socket() as probe:
            if probe.connect_ex((HOST, port)) == 0:
                return
        time.sleep(0.05)
