"""Trials in processes of this machine, each process taking one after another."""

import json
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from multiprocessing import connection, get_context, parent_process
from typing import Any

from swamp_rl.errors import UserError

Work = Callable[[str], str]
"""A trial: what it is told, and what it answers. Found by its name in the process that does it."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Sums come out the same however many workers there are, and workers do not crowd each other out."""


class LocalCrew:
    """`places` processes; one that is lost is replaced, and its trial reported as failed."""

    def __init__(self, work: Work, places: int) -> None:
        self._work, self.places = work, places
        self._free: list[Any] = []
        self._busy: dict[Any, tuple[int, Any]] = {}

    def __enter__(self) -> "LocalCrew":
        return self

    def __exit__(self, *_: object) -> None:
        for pipe, process in [*self._free, *((pipe, process) for pipe, (_, process) in self._busy.items())]:
            pipe.close()
            process.kill()
            process.join()

    def give(self, number: int, job: str) -> None:
        """Have trial `number` done; at most `places` at once."""
        pipe, process = self._free.pop() if self._free else self._started()
        self._busy[pipe] = number, process
        pipe.send_bytes(job.encode())

    def take(self) -> tuple[int, str | None, str]:
        """Wait for a trial to end: its number, its answer (None where it failed), what went wrong."""
        pipe: Any = connection.wait(list(self._busy))[0]
        number, process = self._busy.pop(pipe)
        try:
            answer, error = json.loads(pipe.recv_bytes())
        except (EOFError, OSError):
            process.join()
            pipe.close()
            return number, None, f"its process was lost (exit code {process.exitcode})"
        self._free.append((pipe, process))
        return number, answer, error

    def _started(self) -> tuple[Any, Any]:
        spawn = get_context("spawn")
        ours, theirs = spawn.Pipe()
        process = spawn.Process(target=_serve, args=(self._work, theirs), daemon=True)
        before = {name: os.environ.get(name) for name in ONE_THREAD}
        os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
        try:
            process.start()
        finally:
            for name, value in before.items():
                os.environ.pop(name) if value is None else os.environ.update({name: value})
        theirs.close()
        return ours, process


def each_in_processes(work: Work, jobs: Sequence[str], workers: int) -> Iterator[str]:
    """The answer to every job, in their order; UserError where one fails."""
    waiting = iter(enumerate(jobs))
    done: dict[int, str] = {}
    with LocalCrew(work, min(workers, len(jobs))) as crew:
        for number, job in islice(waiting, crew.places):
            crew.give(number, job)
        for wanted in range(len(jobs)):
            while wanted not in done:
                number, answer, error = crew.take()
                if answer is None:
                    raise UserError(f"job {number + 1} of {len(jobs)} failed: {error}")
                done[number] = answer
                for number, job in islice(waiting, 1):
                    crew.give(number, job)
            yield done.pop(wanted)


def attempt(work: Work, job: str) -> tuple[str | None, str]:
    """The answer (None where it failed) and what went wrong, in one line."""
    try:
        return work(job), ""
    except Exception as error:
        return None, " ".join(f"{type(error).__name__}: {error}".split())


def _serve(work: Work, pipe: Any) -> None:
    """In the worker: one job after another until there is nobody left to ask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to all; the sweep ends its workers itself
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            job = pipe.recv_bytes().decode()
            pipe.send_bytes(json.dumps(attempt(work, job)).encode())
        except (EOFError, OSError):
            return


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)
