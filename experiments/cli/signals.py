"""Ctrl-C and SIGTERM as an exception, so that whatever is half-written is removed on the way out."""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)
AGAIN = 0.1  # s


@contextmanager
def stoppable() -> Iterator[list[int]]:
    """Within the block either signal raises KeyboardInterrupt; yields the signals that came, in order.

    An exception that strikes inside a library's callback, as those of the compiler, is lost there or turns
    into another one. So it is raised once more a moment later, and the list tells what it was.
    """
    came: list[int] = []

    def stop(number: int, frame: Any) -> None:
        if number != signal.SIGALRM:
            came.append(number)
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
