"""Ctrl-C and SIGTERM as an exception, so that whatever is half-written is removed on the way out."""

import math
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)
AGAIN = 0.1  # s
GRACE = 2.0
"""Seconds after a signal in which another one interrupts nothing: a vehicle is switched off in them, what is
half-written is removed, a log is kept. A later one interrupts that too."""


@contextmanager
def stoppable() -> Iterator[list[int]]:
    """Within the block either signal raises KeyboardInterrupt, again after GRACE; yields those that came.

    An exception that strikes inside a library's callback, as those of the compiler, is lost there or turns
    into another one. So it is raised once more a moment later, and the list tells what it was.
    """
    came: list[int] = []
    heeded = -math.inf

    def stop(number: int, frame: Any) -> None:
        nonlocal heeded
        if number != signal.SIGALRM:
            came.append(number)
            if time.monotonic() - heeded < GRACE:
                return
            heeded = time.monotonic()
        raise KeyboardInterrupt

    def lost(unraisable: Any) -> None:
        if came and issubclass(unraisable.exc_type, KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
        else:
            hook(unraisable)

    hook = sys.unraisablehook
    before = {number: signal.signal(number, stop) for number in (*SIGNALS, signal.SIGALRM)}
    sys.unraisablehook = lost
    try:
        yield came
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)
