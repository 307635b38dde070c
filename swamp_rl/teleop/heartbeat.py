"""Tells that a thread stands still, and where: one that waits in a call can be neither asked nor ended."""

import logging
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager

DEEPEST = 3
"""Calls that are named."""

log = logging.getLogger("swamp_rl.teleop")


@contextmanager
def heartbeat(beat: Callable[[], float], patience: float) -> Iterator[None]:
    """Within the block, log where this thread is once `beat`, the monotonic time [s] of its last sign of
    life, is older than `patience` [s], and again when it goes on."""
    watched, ended = threading.get_ident(), threading.Event()

    def watch() -> None:
        still: float | None = None
        while not ended.wait(patience / 4):
            last = beat()
            if still is None and time.monotonic() - last > patience:
                still = last
                log.critical(
                    "the clock has stood still for %.0f s, in %s; accepted runs are safe; if it stays so, "
                    "stop the recorder and start it again",
                    time.monotonic() - last,
                    _place(watched),
                )
            elif still is not None and last != still:
                log.critical("the clock goes on after %.0f s", last - still)
                still = None

    watcher = threading.Thread(target=watch, daemon=True, name="heartbeat")
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


def _place(thread: int) -> str:
    """The calls that a thread is in, the innermost first, with its file and line."""
    frame = sys._current_frames().get(thread)
    calls = traceback.extract_stack(frame)[::-1][:DEEPEST] if frame is not None else []
    return " < ".join(f"{call.name} ({call.filename}:{call.lineno})" for call in calls)
