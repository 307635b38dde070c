"""Signals held back while a process is started, in this process and in the one that starts."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def held() -> Iterator[None]:
    """Within the block no handler of ENDS is called; those of signals that came are called at its end.

    In a thread other than the main one the block changes nothing: handlers are called in the main one only.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []

    def note(number: int, frame: Any) -> None:
        came.append(number)

    before = {number: handler for number in ENDS if callable(handler := signal.getsignal(number))}
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for heard in came:
            signal.raise_signal(heard)


@contextmanager
def born_deaf() -> Iterator[None]:
    """Processes started in the block hold SIGINT back until `heed`: Ctrl-C goes to all of a terminal."""
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def heed() -> None:
    """In such a process: signals end it, except SIGINT, and those that were ignored already."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in ENDS:
        if callable(signal.getsignal(number)):
            signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
