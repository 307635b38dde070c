"""Jobs in processes of this machine, each process taking one after another."""

import json
import os
import shutil
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import connection, get_context, parent_process, resource_tracker
from types import ModuleType
from typing import Any, Self

from swamp_rl.workers.attempt import Work, attempt
from swamp_rl.workers.signals import born_deaf, heed, held

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Sums come out the same however many workers there are, and workers do not crowd each other out."""
ENVIRONMENT = dict.fromkeys((*ONE_THREAD, "PYTHONSAFEPATH"), "1")
"""Of a worker. It begins with `python -c`, which would take `multiprocessing` from the working directory."""


class ProcessPool:
    """`size` processes; one that is lost is replaced, and its job reported as failed."""

    def __init__(self, work: Work, size: int) -> None:
        self._work, self.size = work, size
        self._scratch: tempfile.TemporaryDirectory[str] | None = None
        self._free: list[Any] = []
        self._busy: dict[Any, tuple[int, Any]] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """End the processes, and remove their temporary files, which they are not asked to."""
        for pipe, process in [*self._free, *((pipe, process) for pipe, (_, process) in self._busy.items())]:
            pipe.close()
            process.kill()
            process.join()
        if self._scratch is not None:
            self._scratch.cleanup()

    def submit(self, number: int, job: str) -> None:
        """Have job `number` done; at most `size` at once."""
        while self._free:
            pipe, process = self._free.pop()
            self._busy[pipe] = number, process
            if _sent(job, pipe):
                return
            self._lost(pipe)  # while it was idle
        with self._environment() as scratch:
            resource_tracker.ensure_running()  # its own start would let the signals through
            with held(), born_deaf():  # one half-started would print where it was, or be forgotten
                pipe, process = self._started(scratch)
                self._busy[pipe] = number, process
        _sent(job, pipe)  # else `wait` tells that it was lost

    def wait(self) -> tuple[int, str | None, str]:
        """Wait for a job to end: its number, its answer (None where it failed), what went wrong."""
        pipe: Any = connection.wait(list(self._busy))[0]
        try:
            answer, error = json.loads(pipe.recv_bytes())
        except (EOFError, OSError):
            number, code = self._lost(pipe)
            return number, None, f"its process was lost (exit code {code})"
        number, process = self._busy.pop(pipe)
        self._free.append((pipe, process))
        return number, answer, error

    def _lost(self, pipe: Any) -> tuple[int, int]:
        """Forget a process that has ended: the number of its job, and its exit code."""
        number, process = self._busy[pipe]
        process.join()
        del self._busy[pipe]
        pipe.close()
        return number, process.exitcode

    @contextmanager
    def _environment(self) -> Iterator[str]:
        """That of the workers and of what starts them; yields the folder of their temporary files."""
        if self._scratch is None:
            self._scratch = tempfile.TemporaryDirectory(prefix="swamp-rl-", ignore_cleanup_errors=True)
        own = ENVIRONMENT | {"TMPDIR": self._scratch.name}
        before = {name: os.environ.get(name) for name in own}
        os.environ.update(own)
        try:
            yield self._scratch.name
        finally:
            for name, value in before.items():
                os.environ.pop(name) if value is None else os.environ.update({name: value})

    def _started(self, scratch: str) -> tuple[Any, Any]:
        spawn = get_context("spawn")
        ours, theirs = spawn.Pipe()
        process = spawn.Process(target=_serve, args=(self._work, theirs, scratch), daemon=True)
        with _unseen_script(self._work):
            process.start()
        theirs.close()
        return ours, process


@contextmanager
def _unseen_script(work: Work) -> Iterator[None]:
    """With an empty module in the place of the script that runs, unless the work is a function of that: a
    new process would run the script too, and so ask for workers of its own.
    """
    script = sys.modules["__main__"]
    if work.__module__ != script.__name__:
        sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _sent(job: str, pipe: Any) -> bool:
    """Whether there was a process to take the job."""
    try:
        pipe.send_bytes(job.encode())
    except OSError:
        return False
    return True


def _serve(work: Work, pipe: Any, scratch: str) -> None:
    """In the worker: one job after another until there is nobody left to ask."""
    heed()  # all but Ctrl-C, which goes to all: the parent ends its workers itself
    threading.Thread(target=_end_with_parent, args=(scratch,), daemon=True).start()
    with suppress(EOFError, OSError):
        while True:
            job = pipe.recv_bytes().decode()
            pipe.send_bytes(json.dumps(attempt(work, job)).encode())
    _end_with_parent(scratch)


def _end_with_parent(scratch: str) -> None:
    """Wait for the parent's end, remove the temporary files, which a killed parent leaves, and end."""
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        shutil.rmtree(scratch, ignore_errors=True)
        os._exit(1)
