"""Ctrl-C, SIGTERM and SIGHUP as an exception, so that whatever is half-written is removed on the way out."""

import math
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
ENDED = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}
"""What a command says of itself that one of SIGNALS has ended."""
AGAIN = 0.1  # s
GRACE = 2.0
"""Seconds after a signal in which another one interrupts nothing: a vehicle is switched off in them, what is
half-written is removed, a log is kept. A later one interrupts that too."""


@contextmanager
def stoppable() -> Iterator[list[int]]:
    """Within the block each of SIGNALS raises KeyboardInterrupt, again after GRACE; yields those that came.

    An exception that strikes inside a library's callback, as those of the compiler, is lost there or turns
    into another one. So it is raised once more a moment later, and the list tells what it was. SIGHUP stays
    ignored where it was (nohup); where it came, nothing more is written to the terminal, which is closed.
    """
    came: list[int] = []
    heeded = -math.inf
    terminals = [stream for stream in (1, 2) if os.isatty(stream)]

    def stop(number: int, frame: Any) -> None:
        nonlocal heeded
        if number != signal.SIGALRM:
            came.append(number)
            if number == signal.SIGHUP:
                _to_nowhere(terminals)
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
    heard = [one for one in SIGNALS if one != signal.SIGHUP or signal.getsignal(one) != signal.SIG_IGN]
    before = {number: signal.signal(number, stop) for number in (*heard, signal.SIGALRM)}
    sys.unraisablehook = lost
    try:
        yield came
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


def heed_no_more() -> None:
    """Let signals pass until the end of `stoppable`: the command is over but for its last line."""
    for number in (*SIGNALS, signal.SIGALRM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, lambda number, frame: None)


def _to_nowhere(streams: list[int]) -> None:
    with suppress(OSError):
        null = os.open(os.devnull, os.O_WRONLY)
        for stream in streams:
            os.dup2(null, stream)
        os.close(null)
