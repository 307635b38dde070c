"""Numbered jobs, from text to text, done by a pool of workers, and again where one was lost."""

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Protocol

from swamp_rl.errors import UserError
from swamp_rl.workers.attempt import Work


class Pool(AbstractContextManager["Pool"], Protocol):
    """Workers of one kind of job; left as a context, it ends them."""

    @property
    def size(self) -> int:
        """How many jobs at once."""

    def submit(self, number: int, job: str) -> None:
        """Have a job done; at most `size` at once."""

    def wait(self) -> tuple[int, str | None, str]:
        """Wait for a job to end: its number, its answer (None where it failed), what went wrong."""


@dataclass(frozen=True)
class Ended:
    """A job that is over."""

    number: int
    answer: str | None
    "None where every attempt failed."
    error: str
    "Error of the last attempt."
    attempts: int
    seconds: float
    "Wall time from its first submission."


def open_pool(work: Work, workers: int | None, ray: str | None) -> Pool:
    """Workers for `work`: `workers` processes, by default one for each processor, or the Ray cluster at the
    address `ray`. UserError where no cluster answers there.
    """
    if ray is not None:
        from swamp_rl.workers.cluster import RayPool

        return RayPool(work, ray)
    from swamp_rl.workers.processes import ProcessPool

    return ProcessPool(work, workers or os.cpu_count() or 1)


def completed(numbers: Iterable[int], job: Callable[[int], str], pool: Pool, retries: int) -> Iterator[Ended]:
    """Every job as it ends; one that failed is submitted again, after the others, up to `retries` times."""
    waiting, running = deque(numbers), set[int]()
    attempts, began = Counter[int](), dict[int, float]()
    while waiting or running:
        while waiting and len(running) < pool.size:
            number = waiting.popleft()
            began.setdefault(number, time.perf_counter())
            pool.submit(number, job(number))
            running.add(number)
        number, answer, error = pool.wait()
        running.remove(number)
        attempts[number] += 1
        if answer is None and attempts[number] <= retries:
            waiting.append(number)
        else:
            yield Ended(number, answer, error, attempts[number], time.perf_counter() - began[number])


def answers(work: Work, jobs: Sequence[str], workers: int | None = None) -> Iterator[str]:
    """The answer to every job, in their order, by processes; UserError where one fails."""
    done: dict[int, str] = {}
    wanted = 0
    with open_pool(work, min(workers or os.cpu_count() or 1, max(len(jobs), 1)), None) as pool:
        for ended in completed(range(len(jobs)), lambda number: jobs[number], pool, retries=0):
            if ended.answer is None:
                raise UserError(f"job {ended.number + 1} of {len(jobs)} failed: {ended.error}")
            done[ended.number] = ended.answer
            while wanted in done:
                yield done.pop(wanted)
                wanted += 1
