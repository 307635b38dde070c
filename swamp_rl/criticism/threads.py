"""Work on many windows, divided among threads."""

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from itertools import pairwise
from typing import TypeVar

import numba
import numpy as np

from swamp_rl.criticism.options import options

T = TypeVar("T")
R = TypeVar("R")

SHARE: ContextVar[int | None] = ContextVar("SHARE", default=None)
"""Threads that a thread of `each` may divide its own work among; None elsewhere: numba's number of them."""


def divided(part: Callable[[slice], None], count: int, steps: int) -> None:
    """Call `part` with slices of `count` items, on a thread for each `thread_steps` boat steps, at most
    numba's number of them: to start threads takes as long as many of the small simulations of a fit.

    The bits do not depend on the number of threads where `part` treats each item alone. Each thread has the
    options and NumPy's error handling of the caller.
    """
    threads = min(_most_threads(), count, steps // options().thread_steps)
    if threads < 2:
        part(slice(0, count))
        return
    edges = np.linspace(0, count, threads + 1).astype(int)
    own, *others = [slice(*ends) for ends in pairwise(edges.tolist())]
    with ThreadPoolExecutor(threads - 1) as pool:
        begun = [pool.submit(copy_context().run, part, one) for one in others]
        part(own)
        for one in begun:
            one.result()


def each(work: Callable[[T], R], items: Sequence[T]) -> list[R]:
    """The results of work on each item, on at most `most_together` threads, among which numba's are shared:
    for work that shares no state and is long beside the start of a thread. Each thread has the options and
    NumPy's error handling of the caller.
    """
    available = _most_threads()
    threads = min(available, len(items), options().most_together)
    if threads < 2:
        return [work(one) for one in items]

    def inside(item: T) -> R:
        SHARE.set(available // threads)
        return work(item)

    with ThreadPoolExecutor(threads) as pool, _often_switched():
        begun = [pool.submit(copy_context().run, inside, one) for one in items]
        try:
            return [one.result() for one in begun]
        finally:  # after an error, or Ctrl-C, the others are not begun
            pool.shutdown(wait=False, cancel_futures=True)


def _most_threads() -> int:
    share = SHARE.get()
    return numba.config.NUMBA_NUM_THREADS if share is None else share


@contextmanager
def _often_switched() -> Iterator[None]:
    """Within the block a thread that comes back from compiled code waits less long for Python's lock."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(options().switch_interval)
    try:
        yield
    finally:
        sys.setswitchinterval(before)
