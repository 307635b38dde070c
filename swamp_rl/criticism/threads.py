"""Work on many windows, divided among threads."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from itertools import pairwise
from typing import TypeVar

import numba
import numpy as np

from swamp_rl.criticism.options import options

T = TypeVar("T")
R = TypeVar("R")


def divided(part: Callable[[slice], None], count: int, steps: int) -> None:
    """Call `part` with slices of `count` items, on a thread for each `thread_steps` boat steps, at most
    numba's number of them: to start threads takes as long as many of the small simulations of a fit.

    The bits do not depend on the number of threads where `part` treats each item alone. Each thread has the
    options and NumPy's error handling of the caller.
    """
    threads = min(numba.config.NUMBA_NUM_THREADS, count, steps // options().thread_steps)
    if threads < 2:
        part(slice(0, count))
        return
    edges = np.linspace(0, count, threads + 1).astype(int)
    with ThreadPoolExecutor(threads) as pool:
        begun = [pool.submit(copy_context().run, part, slice(*ends)) for ends in pairwise(edges)]
        for one in begun:
            one.result()


def each(work: Callable[[T], R], items: Sequence[T]) -> list[R]:
    """The results of work on each item, on numba's number of threads: for work that shares no state and is
    long beside the start of a thread. Each thread has the options and NumPy's error handling of the caller.
    """
    threads = min(numba.config.NUMBA_NUM_THREADS, len(items))
    if threads < 2:
        return [work(one) for one in items]
    with ThreadPoolExecutor(threads) as pool:
        begun = [pool.submit(copy_context().run, work, one) for one in items]
        return [one.result() for one in begun]
