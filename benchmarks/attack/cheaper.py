"""What takes seconds of a command and is no matter of its files, done once or by a fork: more cases in a day.

Each is a context in which a command is done. Its calls on files are the same, in the same order.
"""

import os
import subprocess
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from multiprocessing import get_context
from typing import Any
from unittest.mock import patch

from benchmarks.attack.syscalls import leave

LATE = (
    "h5py",
    "matplotlib.backends.backend_agg",
    "matplotlib.figure",
    "minari",
    "PIL.PngImagePlugin",
    "rerun",
)
FITS = (
    "searched",
    "short_fitted",
    "fitted_boat",
    "run_thrusts",
    "chosen_gains",
    "errors_on",
    "recent_errors",
)
FOUND: list[Any] = []
"What the search among runs found."


def imported() -> None:
    """Import, in the process that is forked, what commands import late."""
    for name in LATE:
        import_module(name)


@contextmanager
def cheaper() -> Iterator[None]:
    """All of the contexts below."""
    with ExitStack() as stack:
        for one in (figures_left_blank, workers_forked, apart_by_a_fork, searched_once, fitted_once):
            stack.enter_context(one())
        yield


@contextmanager
def figures_left_blank() -> Iterator[None]:
    """Figures are laid out and drawn by no one; blank, they are saved as ever."""
    from matplotlib.figure import Figure

    with patch.object(Figure, "draw", lambda figure, renderer: None):
        yield


@contextmanager
def workers_forked() -> Iterator[None]:
    """A sweep's workers are forks, not processes begun anew."""
    local = import_module("swamp_rl.workers.processes")
    with patch.object(local, "get_context", lambda kind: get_context("fork")):
        yield


@contextmanager
def searched_once() -> Iterator[None]:
    """A diagnosis's search among runs in memory, which touches no file, is done once for all cases."""
    module = import_module("swamp_rl.criticism.diagnose")
    search = module.examine

    def once(*given: Any) -> Any:
        FOUND.extend([] if FOUND else [search(*given)])
        return FOUND[0]

    with patch.object(module, "examine", once):
        yield


@contextmanager
def fitted_once() -> Iterator[None]:
    """The fits of an identification to runs in memory are done once for all cases."""
    module = import_module("swamp_rl.boat_fit.identify")
    with ExitStack() as stack:
        for name in FITS:
            stack.enter_context(patch.object(module, name, _in_order(getattr(module, name))))
        yield


def _in_order(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, whose nth call in a fork is answered with what its nth call before gave."""
    found: list[Any] = []
    calls = Counter[int]()

    def once(*given: Any) -> Any:
        place = calls[os.getpid()]
        calls[os.getpid()] += 1
        if place == len(found):
            found.append(function(*given))
        return found[place]

    return once


@contextmanager
def apart_by_a_fork() -> Iterator[None]:
    """What a command does in a process begun anew is done in a fork, HDF5 being unused in the one forked."""
    module = import_module("swamp_rl.runs.apart")

    class Forking:
        """In place of the module `subprocess`."""

        @staticmethod
        def run(start: list[str], input: bytes, **_: Any) -> subprocess.CompletedProcess[bytes]:
            return _answered(start, input, module.answer)

    with patch.object(module, "subprocess", Forking):
        yield


def _answered(start: list[str], asked: bytes, answer: Any) -> subprocess.CompletedProcess[bytes]:
    """As `subprocess.run` with its output captured, of a fork that calls `answer`."""
    with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        given.write(asked)
        given.seek(0)
        child = os.fork()
        if child == 0:
            code = 1
            try:
                for number, file in enumerate((given, out, err)):
                    os.dup2(file.fileno(), number)
                sys.stdin = os.fdopen(0)
                answer()
                code = 0
            except BaseException:
                traceback.print_exc()
            finally:
                leave(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read())
    return subprocess.CompletedProcess(start, code, *texts)
