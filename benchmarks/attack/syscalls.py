"""A process whose system calls fail, end it, or are written down; and work done in forks of it.

with_shim("benchmarks.attack.faults", words)   runs a module where the calls are in our hand
armed(folder, "write", errno.ENOSPC, 3)         there: the third write to a file in the folder fails
forked(work)                                    does work in a child; how it ended and its output
"""

import atexit
import ctypes
import gc
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.attack.counts import Count

KINDS = ("open", "write", "fsync", "rename", "close", "any")
"Of calls that are counted, each kind by itself; `any` counts all of them."
KILL = -1
"In place of an error number: the process is killed before the call."
SOURCE = Path(__file__).with_name("syscalls.c")
SHIM = "SWAMP_ATTACK_SHIM"
REPORT = "counted: "
"What a line of a report begins with; all else is what commands say."


def with_shim(module: str, words: Sequence[str]) -> Iterator[Count]:
    """What a module reports that runs, to its end, in a process whose calls are intercepted.

    RuntimeError where no C compiler is installed, and where the process ends otherwise than well.
    """
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise RuntimeError("no C compiler is installed, which builds what has system calls fail")
    with tempfile.TemporaryDirectory() as folder:
        shim = Path(folder) / "syscalls.so"
        flags = ["-O2", "-shared", "-fPIC", "-o", str(shim), str(SOURCE), "-ldl", "-lpthread"]
        subprocess.run([compiler, *flags], check=True)
        # One thread, so that forks of it do not wait for threads that they do not have.
        one = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        one |= {"NUMBA_THREADING_LAYER": "workqueue"}  # that of OpenMP ends a fork that uses it
        env = os.environ | one | {"LD_PRELOAD": str(shim), SHIM: str(shim)}
        words = [sys.executable, "-m", module, *words]
        with subprocess.Popen(words, env=env, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                if line.startswith(REPORT):
                    yield Count(**json.loads(line.removeprefix(REPORT)))
        if process.returncode != 0:
            raise RuntimeError(f"{module} ended with {process.returncode}")


def report(count: Count) -> None:
    """Tell the process that started this one `with_shim`."""
    print(REPORT + json.dumps(asdict(count)), flush=True)


def _shim() -> ctypes.CDLL:
    return ctypes.CDLL(os.environ[SHIM])


def armed(folder: Path, kind: str = "any", error: int = 0, nth: int = 0, lasting: bool = False) -> None:
    """Have the `nth` call (0: none) of a kind on files in `folder` fail, and all later ones if `lasting`.

    So it is in this process and, each counting for itself, in those that it starts.
    """
    os.environ["SWAMP_ATTACK_ARMED"] = f"{KINDS.index(kind)} {error} {nth} {int(lasting)} {folder}"
    _shim().fault_arm(str(folder).encode(), KINDS.index(kind), error, ctypes.c_long(nth), int(lasting))


def counts_to(file: Path) -> None:
    """Have this process and those that it starts write, as they end, how many calls each has made."""
    os.environ["SWAMP_ATTACK_COUNTS"] = str(file)


def most_counted(file: Path) -> dict[str, int]:
    """By kind, the most calls that one of the processes has made."""
    lines = [[int(word) for word in line.split()] for line in file.read_text().splitlines()]
    return dict(zip(KINDS, map(max, zip(*lines, strict=True)), strict=True))


def logged_to(file: int) -> None:
    """Write every call that changes a file to a descriptor."""
    _shim().fault_log(file)


def mark(text: str) -> None:
    """Write a line of one's own among the calls."""
    _shim().fault_mark(text.encode())


@contextmanager
def scratch() -> Iterator[Path]:
    """A folder that is removed afterwards. Unlike those of `tempfile`, not at the exit of a fork too."""
    folder = Path(tempfile.mkdtemp(prefix="attack-"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@dataclass(frozen=True)
class Ended:
    """How a child ended: `code`, its exit status or minus the signal; its output; whether it hung."""

    code: int
    out: str
    err: str
    hung: bool


def forked(work: Callable[[], int | None], limit: float = 60.0) -> Ended:
    """Do `work` in a fork and wait; its value is the exit status, 70 where it raises. limit: [s]."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        sys.stdout.flush()
        sys.stderr.flush()
        gc.freeze()  # or a fork, at its end, would copy all that the process holds to look through it
        child = os.fork()
        if child == 0:
            code = 70
            try:
                os.dup2(out.fileno(), 1)
                os.dup2(err.fileno(), 2)
                code = work() or 0
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else 0
            except BaseException:
                traceback.print_exc()
            finally:
                leave(code)
        hung = not _ended(child, limit)
        if hung:
            os.kill(child, signal.SIGKILL)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return Ended(code, texts[0], texts[1], hung)


def leave(code: int) -> None:
    """End a fork as a process ends, with what Python and libraries do at exit, but for the frames above."""
    gc.collect()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    ctypes.CDLL(None).exit(code)


def _ended(child: int, limit: float) -> bool:
    until = time.monotonic() + limit
    while time.monotonic() < until:
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None:
            return True
        time.sleep(0.002)
    return False
