"""A job that is killed again and again, and at last left to end."""

import math
import os
import random
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot, save_pilot
from tests.support import forks
from tests.support.pages import environment


class KilledError(Exception):
    """Stands for the end of the process."""


def killed_until_done(job: Callable[[], None], checkpoint: Path, chance: random.Random) -> tuple[int, bool]:
    """How often forks that do `job` were killed before one came to its end, and whether that one did it.

    Each life is killed at a random instant after the checkpoint of a life before has been replaced, however
    slow the machine is: a life without a checkpoint of its own would only be begun anew. It leaves two
    checkpoints at most, so that there are many lives however fast the later ones follow.
    """
    kills = 0
    while True:
        before, began = _stamp(checkpoint), time.perf_counter()
        child = os.fork()
        if child == 0:
            job()
            os._exit(0)
        first = _replaced(checkpoint, before, child, math.inf)
        now = time.perf_counter()
        _replaced(checkpoint, first, child, now + 0.4 * chance.random() * (now - began))
        os.kill(child, signal.SIGKILL)
        status = os.waitpid(child, 0)[1]
        if status != signal.SIGKILL:
            return kills, status == 0
        kills += 1


def lead_lives(trained: Callable[[Path], Pilot]) -> None:
    """For a process of its own with the arguments FOLDER and SEED: a pilot `trained` from the checkpoint that
    it is given is saved as FOLDER/pilot, and how often its lives were killed is printed.
    """
    folder, chance = Path(sys.argv[1]), random.Random(int(sys.argv[2]))
    checkpoint = folder / "checkpoint"
    kills, done = killed_until_done(
        lambda: save_pilot(trained(checkpoint), folder / "pilot"), checkpoint, chance
    )
    print(kills)
    sys.exit(not done)


def killed_training(kind: str, folder: Path) -> tuple[int, Pilot]:
    """How often the lives of `tests.support.killed_KIND` were killed in a folder, and the pilot at last."""
    script = Path(__file__).with_name(f"killed_{kind}.py")
    done = forks.run(forks.SCRIPT, [str(script), str(folder), "1"], folder, environment())
    assert done.returncode == 0, done.stderr
    return int(done.stdout), load_pilot(folder / "pilot")


def assert_same_weights(one: Pilot, other: Pilot) -> None:
    """The same, bit for bit."""
    for name, value in one.weights().items():
        np.testing.assert_array_equal(other.weights()[name], value, strict=True)


def _replaced(path: Path, before: tuple[int, int] | None, child: int, until: float) -> tuple[int, int] | None:
    """What a file is once it is another than before, the child has ended or the clock [s] shows `until`."""
    while (found := _stamp(path)) == before and not _ended(child) and time.perf_counter() < until:
        time.sleep(0.002)
    return found


def _stamp(path: Path) -> tuple[int, int] | None:
    """What changes when a file is replaced."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return found.st_ino, found.st_mtime_ns


def _ended(child: int) -> bool:
    """Whether it has ended, leaving its status to be read."""
    return os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
