"""Work in a process of its own: HDF5 ends its process by a segmentation fault where a disk is full."""

import functools
import os
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

from swamp_rl.errors import UserError

P = ParamSpec("P")
R = TypeVar("R")

START = "import sys; sys.path[:] = sys.argv[1:]; from swamp_rl.runs.apart import answer; answer()"
REFUSED = re.compile(r"errno = (\d+)")
"How HDF5 tells the operating system's refusal."


def apart(work: Callable[P, R]) -> Callable[P, R]:
    """`work`, a function of a module, done in a new process: its value, or the UserError that it raises.

    However else that process ends, OSError if it printed the operating system's refusal, UserError if not.
    """

    @functools.wraps(work)
    def done(*args: P.args, **kwargs: P.kwargs) -> R:
        asked = pickle.dumps((work.__module__, work.__qualname__, args, kwargs))
        start = [sys.executable, "-P", "-c", START, *sys.path]
        ended = subprocess.run(start, input=asked, capture_output=True, check=False)
        if ended.returncode == 0:
            value, refusal = pickle.loads(ended.stdout)
            if refusal is not None:
                raise UserError(refusal)
            return value
        output = ended.stderr.decode(errors="replace")
        if refused := REFUSED.search(output):
            raise OSError(int(refused[1]), os.strerror(int(refused[1])))
        last = output.strip().splitlines()[-1:] or ["no message"]
        raise UserError(f"the process that wrote it ended with {ended.returncode}: {last[0]}")

    return done


def answer() -> None:
    """The new process: do what is asked on standard input, and answer on what was standard output."""
    answered = os.dup(1)
    os.dup2(2, 1)  # what libraries print is no part of the answer
    module, name, args, kwargs = pickle.load(sys.stdin.buffer)
    work: Any = getattr(import_module(module), name).__wrapped__
    result: tuple[Any, str | None]
    try:
        result = (work(*args, **kwargs), None)
    except UserError as error:
        result = (None, str(error))
    with os.fdopen(answered, "wb") as out:
        pickle.dump(result, out)
