"""A recorder killed before any of its system calls: no accepted run is lost, what was not is marked.

python -m benchmarks.attack kills [--count 1000] [--seed 1]

Each case accepts short runs in a dataset that earlier kills left behind, is killed by SIGKILL before
the Nth call on its files, N drawn anew, and is opened again.
"""

import os
import shutil
import sys
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.attack.counts import Count
from benchmarks.attack.recorder import driven, recorder, warm, write_course
from benchmarks.attack.samples import parse_once
from benchmarks.attack.syscalls import (
    KILL,
    armed,
    counts_to,
    forked,
    most_counted,
    report,
    scratch,
    with_shim,
)

COUNT, QUICK = 1000, 40
LIVES = 25
"Kills in one dataset, then another is begun: reading it takes longer with each run."


def drive_and_accept(case: Path) -> None:
    """Accept two runs of three, each reported once it is accepted."""
    game, now = recorder(case), 0.0
    for keep in (True, False, True):
        now = driven(game, now)
        if keep:
            name = game.accept()()
            game.accepted()
            os.write(1, f"accepted {name}\n".encode())
        else:
            game.drop(again=False)
    game.close()


def wrong_after(case: Path, accepted: set[str], kills: int) -> str | None:
    """What is wrong with the dataset, opened again after so many kills; None if nothing is."""
    from swamp_rl.runs import check_dataset, read_dataset
    from swamp_rl.runs.dataset import META
    from swamp_rl.teleop.rows import largest_difference

    if not (case / "out" / META).exists():
        return "the dataset is gone" if accepted else None
    recorder(case).close()
    if left := sorted((case / "out" / "unfinished").glob("run-*")):
        return f"{left[0].name} stays unfinished"
    from swamp_rl.runs.dataset import read_meta

    if not read_meta(case / "out").runs:
        return f"lost {accepted}" if accepted else None
    if faults := check_dataset(case / "out"):
        return str(faults[0])
    runs = {run.name: run for run in read_dataset(case / "out").runs}
    if lost := accepted - set(runs):
        return f"lost {lost}"
    interrupted = [name for name, run in runs.items() if run.meta.outcome == "interrupted"]
    if accepted & set(interrupted) or len(interrupted) > kills:
        return f"interrupted: {interrupted}"
    newest = [runs[name] for name in sorted(runs)[-4:]]
    # One that was not accepted, whose description a power cut took, is kept but tells not where it began.
    newest = [run for run in newest if run.name in accepted or run.meta.initial_state]
    if any(largest_difference(run, "swamp") != 0.0 for run in newest):
        return "a run does not sail again to the bit"
    return None


def killed(count: int, seed: int) -> Count:
    """Counts of kills and of what cannot be explained about them."""
    rng = np.random.default_rng(seed)
    unexplained: list[str] = []
    with scratch() as root:
        warm(root / "warm", drive_and_accept)
        case, kills, accepted = root / "case", 0, set[str]()
        calls = 0
        for number in range(count):
            if number % LIVES == 0:
                shutil.rmtree(case, ignore_errors=True)
                write_course(case)
                kills, accepted = 0, set()
            calls = calls or _calls(case)
            nth = int(rng.integers(1, calls + 1))

            def life(case: Path = case, nth: int = nth) -> None:
                armed(case / "out", "any", KILL, nth)
                drive_and_accept(case)

            ended = forked(life)
            kills += 1
            accepted |= {line.split()[1] for line in ended.out.splitlines() if line.startswith("accepted")}
            try:
                wrong = wrong_after(case, accepted, kills)
            except Exception as error:
                wrong = f"{type(error).__name__}: {error}"
            if ended.code not in (0, -9):
                wrong = f"ended with {ended.code}: {ended.err[-200:]}"
            if wrong:
                unexplained.append(f"kill {number} before call {nth}: {wrong}")
                print(unexplained[-1], file=sys.stderr, flush=True)
    return Count("kills", "of a recorder, before any system call", count, unexplained, seed=seed)


def _calls(case: Path) -> int:
    """How many calls one life makes."""
    file = case / "calls"

    def life() -> None:
        counts_to(file)
        armed(case / "out")
        drive_and_accept(case)

    forked(life)
    shutil.rmtree(case / "out")
    return most_counted(file)["any"]


def attack(asked: Namespace) -> Iterator[Count]:
    """Counts, from a process whose calls are in our hand."""
    count = asked.count or (QUICK if asked.quick else COUNT)
    yield from with_shim("benchmarks.attack.kills", [str(count), str(asked.seed)])


if __name__ == "__main__":
    parse_once()
    report(killed(int(sys.argv[1]), int(sys.argv[2])))
