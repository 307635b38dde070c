"""Programs, each a process of its own, forked from one process that has imported the libraries already.

    python -m tests.support.forks

reads from standard input a line of JSON for each program and answers with its exit status. It starts no
thread of its own, so that its forks may start theirs.
"""

import atexit
import gc
import importlib
import json
import os
import runpy
import signal
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import IO
from unittest.mock import patch

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.simulator.reference import reference_of
from tests.support.patience import PATIENCE

LIBRARIES = (
    "matplotlib.pyplot",
    "reservoirpy.nodes",
    "scipy.optimize",
    "scipy.stats",
    "stable_baselines3",
    "swamp_rl.criticism.diagnose",
    "swamp_rl.envs.batched",
    "swamp_rl.evaluation",
    "swamp_rl.experiments.cli.app",
    "swamp_rl.experiments.studies.run",
    "swamp_rl.simulator",
    "torch",
    "torch._dynamo",  # a second that each training would take
)
SCRIPT, COMMAND = "script", "command"
GROUP = pytest.mark.xdist_group("forks")
"""Of all tests that run forks: one worker begins the process that is forked, 5 s of imports."""


@cache
def server(environment: tuple[tuple[str, str], ...]) -> subprocess.Popen[str]:
    """The process that forks, begun once for each environment; it ends with this one."""
    started = subprocess.Popen(
        [sys.executable, "-m", __name__],
        env=dict(environment),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    atexit.register(started.communicate)
    return started


def run(
    kind: str, words: Sequence[str], folder: Path, environment: dict[str, str]
) -> subprocess.CompletedProcess[str]:
    """A script or the package's own command with its arguments, run in `folder` to its end."""
    same = {name: value for name, value in environment.items() if name != "PYTEST_CURRENT_TEST"}
    process = server(tuple(sorted(same.items())))
    assert process.stdin is not None and process.stdout is not None
    out, error = folder / ".stdout", folder / ".stderr"
    asked = {"kind": kind, "words": list(words), "folder": str(folder), "streams": [str(out), str(error)]}
    process.stdin.write(json.dumps(asked) + "\n")
    process.stdin.flush()
    status = int(process.stdout.readline())
    listed = [file.read_text(encoding="utf-8") for file in (out, error)]
    for file in (out, error):
        file.unlink()
    return subprocess.CompletedProcess(list(words), status, *listed)


def _serve(lines: IO[str], answers: IO[str]) -> None:
    """Answer the lines.

    A fork of multiprocessing does not take apart at its end all that is imported, nor does it look through
    what is frozen for garbage: together a second.
    """
    for name in LIBRARIES:
        importlib.import_module(name)
    reference_of(load_boat("swamp"))  # what compiles and loads machine code begins, once for all forks
    gc.freeze()
    for line in lines:
        fork = get_context("fork").Process(target=_become, args=(json.loads(line),))
        fork.start()
        fork.join()
        answers.write(f"{fork.exitcode}\n")
        answers.flush()


def _become(asked: dict[str, str]) -> None:
    """Be the program: its folder, streams and arguments, then its work; one that hangs is ended.

    The workers that it starts are forks too, with the libraries imported.
    """
    from swamp_rl.workers import processes

    signal.alarm(round(PATIENCE))
    for number, name in enumerate((os.devnull, *asked["streams"])):
        opened = os.open(name, os.O_RDONLY if number == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        os.dup2(opened, number)
        os.close(opened)
    os.chdir(asked["folder"])
    sys.argv = list(asked["words"])
    try:
        with patch.object(processes, "get_context", lambda kind: get_context("fork")):
            if asked["kind"] == SCRIPT:
                sys.path[0] = str(Path(sys.argv[0]).parent)
                runpy.run_path(sys.argv[0], run_name="__main__")
            else:
                from swamp_rl.experiments.cli import main

                sys.path[0] = str(Path(sys.executable).parent)
                main()
    finally:
        atexit._run_exitfuncs()


if __name__ == "__main__":
    _serve(sys.stdin, sys.stdout)
