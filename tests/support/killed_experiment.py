"""Lives of a job that are ended by SIGKILL, in a process of its own.

    python -m tests.support.killed_experiment FOLDER SEED

Every opening, renaming, making and removing of a file in FOLDER is an instant at which a life may end. The
process does the job once unbroken, counting them; then again in forked lives, each killed at one drawn by the
seed, until one comes to its end. Forked, because so a life needs no imports.
"""

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from swamp_rl.experiments.studies.run import run_experiment

from tests.support.tiny_experiment import empty_figures

INSTANTS = ("open", "os.", "shutil.")
MOST = 12  # lives that are killed, before one may go on to its end


def count_instants(folder: Path, done: Callable[[int], None]) -> None:
    """Have `done` hear of each instant in the folder, with its number, from now on."""
    number = 0

    def hear(event: str, words: tuple[object, ...]) -> None:
        nonlocal number
        if event.startswith(INSTANTS) and any(str(word).startswith(str(folder)) for word in words[:2]):
            number += 1
            done(number)

    sys.addaudithook(hear)


def life(file: Path, out: Path, ends_at: int) -> bool:
    """Whether a life that is to be killed at the instant of that number came to its end before."""
    child = os.fork()
    if child == 0:

        def kill(number: int) -> None:
            if number == ends_at:
                os.kill(os.getpid(), signal.SIGKILL)

        count_instants(file.parent, kill)
        run_experiment(file, out=out)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    if not os.WIFSIGNALED(status) and os.waitstatus_to_exitcode(status) != 0:
        raise RuntimeError("a life ended by itself with an error")
    return not os.WIFSIGNALED(status)


def main(folder: Path, seed: int) -> None:
    """Write `folder`/unbroken and `folder`/broken; the last line printed: how many lives the latter took."""
    with empty_figures():
        last = [0]
        count_instants(folder, lambda number: last.__setitem__(0, number))
        run_experiment(folder / "tiny.yaml", out=folder / "unbroken")
        ends = np.random.default_rng(seed).integers(1, last[0], MOST).tolist()
        for lives, ends_at in enumerate([*ends, 0], start=1):
            if life(folder / "tiny.yaml", folder / "broken", ends_at):
                print(lives)
                return


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
