"""Every command on a disk that refuses.

ENOSPC, EIO, EMFILE, EACCES at the Nth open, write, fsync, rename, close.

python -m benchmarks.attack faults [--only COMMAND] [--count PLACES]

A case is one command with one refusal, once or from then on, in a folder of its own. It is unexplained unless
the command ends well, or with one line on the error stream and status 2; that line names nothing hidden where
a write failed; its inputs are unchanged; what it was to write is there as a whole or not at all; and, of the
recorder, every accepted run is there and sails again to the bit.
"""

import errno
import hashlib
import re
import shutil
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.attack.cheaper import cheaper, imported
from benchmarks.attack.counts import Count
from benchmarks.attack.recorder import record, recorded, write_course
from benchmarks.attack.samples import parse_once
from benchmarks.attack.syscalls import (
    Ended,
    armed,
    counts_to,
    forked,
    most_counted,
    report,
    scratch,
    with_shim,
)
from swamp_rl.files import UNFINISHED

ERRORS = (errno.ENOSPC, errno.EIO, errno.EMFILE, errno.EACCES)
CALLS = ("open", "write", "fsync", "rename", "close")
PLACES, QUICK_PLACES = 24, 2  # values of N for each command, call and error; spread over all calls it makes
SLOW_PLACES = 48  # of `run`: ten minutes of one core; all of its places would take forty
SEED = 0
LIMIT = 900.0  # s for one case, on a machine that is busy with other work

EXPERIMENT = """
name: tiny
boat: swamp
course: camogli
data: {folder: %s}
pilots:
  reservoir: {kind: reservoir, takeover: 1.0, options: {units: 20}}
  net: {kind: cloning, takeover: 1.0, options: {epochs: 1}}
evaluation: {levels: [calm], episodes: 2, seed: 1, shown: 1}
"""
SWEEP = """
name: tiny
experiment: %s
set: {pilots.reservoir.takeover: 0.0}
parameters: {pilots.reservoir.options.units: {grid: [10, 20]}}
objective: {pilot: reservoir, level: calm}
"""


@dataclass(frozen=True)
class Command:
    """What is done in a case's folder, which holds a copy of the inputs; `out` is what it writes there."""

    do: Callable[[Path], int | None]
    out: str = "out"
    left: tuple[str, ...] = ()
    "What a command that failed may leave beside `out`, for the next life to go on from."
    check: Callable[[Path, Ended], str | None] | None = None
    "What is wrong in the folder of a command that may leave less than all; the others leave all or nothing."
    codes: tuple[int, ...] = (0, 2)
    places: int = PLACES
    warmed_by: str | None = None
    "The command done once in the process that is forked, so that no fork compiles anew; by default itself."


def verb(*words: str) -> Callable[[Path], int | None]:
    """The command line's verb with these words, `{}` being the case's folder."""

    def do(case: Path) -> None:
        from swamp_rl.experiments.cli import main

        sys.argv = ["swamp-rl", *(word.format(case) for word in words)]
        main()

    return do


FLEET = verb("fleet", "{}/inputs/runs", "{}/inputs/more", "--out", "{}/out", "--workers", "1")


def resumed(case: Path, ended: Ended) -> str | None:
    """What is wrong with the folder of a fleet, and with what the same command makes of it afterwards."""
    from swamp_rl.experiments.fleet.result import Fleet
    from swamp_rl.experiments.fleet.work import read_diagnosis

    out = case / "out"
    for folder in out.glob("[!.]*/"):
        read_diagnosis(folder)
    if ended.code != 2:
        summary = Fleet.model_validate_json((out / "fleet.json").read_bytes())
        if any(one.verdict is None and one.error is None for one in summary.members):
            return "a dataset has neither a diagnosis nor an error"
    again = forked(partial(FLEET, case), LIMIT)
    if again.code != 0 or again.err:
        return f"cannot be resumed: {again}"
    whole = Fleet.model_validate_json((out / "fleet.json").read_bytes())
    if [one.verdict for one in whole.members].count(None):
        return "the same command does not diagnose every dataset afterwards"
    return None


COMMANDS = {
    "record": Command(record, check=recorded),
    "import": Command(
        verb("runs", "import", "{}/inputs/log.csv", "--from", "csv", "--out", "{}/out", "--boat", "swamp")
    ),
    **{
        f"export {to}": Command(verb("runs", "export", "{}/inputs/runs", "--to", to, "--out", "{}/out"))
        for to in ("csv", "parquet", "minari", "lerobot", "mcap")
    },
    "train": Command(
        verb("train", "{}/inputs/tiny.yaml", "--set", "data.folder={}/inputs/runs", "--out", "{}/out"),
        left=(".part-out",),
    ),
    "run": Command(
        verb("run", "{}/inputs/tiny.yaml", "--set", "data.folder={}/inputs/runs", "--out", "{}/out"),
        left=(".part-out",),
        places=SLOW_PLACES,
        warmed_by="train",  # rerun, which writes its recordings, is not to be used on both sides of a fork
    ),
    "evaluate": Command(
        verb("evaluate", "{}/inputs/trained", "--out", "{}/out"), left=(".part-out",), warmed_by="train"
    ),
    "compare": Command(
        verb("compare", "{}/inputs/results", "{}/inputs/others", "--out", "{}/out", "--seed", "1"),
    ),
    "sweep": Command(
        verb(
            *("sweep", "{}/inputs/sweep.yaml", "--set", "data.folder={}/inputs/runs"),
            *("--workers", "1", "--out", "{}/out"),
        ),
        left=("out",),
        warmed_by="train",
    ),
    "diagnose": Command(verb("diagnose", "{}/inputs/runs", "--out", "{}/out")),
    "fleet": Command(FLEET, left=("out",), check=resumed, codes=(0, 1, 2), warmed_by="diagnose"),
    "identify boat": Command(
        verb("identify", "boat", "{}/inputs/runs", "--boat", "swamp", "--out", "{}/out/boat.yaml")
    ),
}


def prepare(inputs: Path) -> None:
    """What the commands read."""
    from swamp_rl.envs.batched import GatesVectorEnv

    from swamp_rl.pilots.record import record_scripted
    from swamp_rl.runs import read_dataset, write_run

    write_course(inputs.parent)
    (inputs / "tiny.yaml").write_text(EXPERIMENT % (inputs / "runs"))
    (inputs / "sweep.yaml").write_text(SWEEP % (inputs / "tiny.yaml"))
    record_scripted(
        lambda n, senses: GatesVectorEnv(n, disturbances="calm", observation=senses),
        inputs / "runs",
        count=2,
        failed=0,
    )
    shutil.copytree(inputs / "runs", inputs / "more")
    write_run(inputs / "log.csv", read_dataset(inputs / "runs").runs[0])
    for what, out, seed in (("train", "trained", 1), ("run", "results", 1), ("run", "others", 2)):
        command = verb(what, "{}/tiny.yaml", "--set", f"evaluation.seed={seed}", "--out", f"{{}}/{out}")
        ended = forked(partial(command, inputs), LIMIT)  # rerun may only be used on one side of a fork
        if ended.code != 0:
            raise RuntimeError(f"{what} fails without a fault: {ended}")


TIMED = re.compile(r"(?<=tfevents)\..*")
"What TensorBoard's names tell of the time, the machine and the process."


def tree(folder: Path) -> dict[str, str]:
    """Digest of each file by relative path."""
    return {
        TIMED.sub("", path.relative_to(folder).as_posix()): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


class Attack:
    """Cases of one command, in folders of their own beside its inputs."""

    def __init__(self, name: str, root: Path) -> None:
        self.name, self.command, self.root = name, COMMANDS[name], root
        self.inputs = tree(root / "inputs")
        ended, self.whole = self._case("write", 0, 0, False, keep=True)
        if ended.code != 0:
            raise RuntimeError(f"{name} fails without a fault: {ended}")

    def _case(
        self, kind: str, error: int, nth: int, lasting: bool, keep: bool = False
    ) -> tuple[Ended, set[str]]:
        case = self.root / "case"
        shutil.rmtree(case, ignore_errors=True)
        case.mkdir()
        shutil.copytree(self.root / "inputs", case / "inputs")

        def work() -> int | None:
            if keep:
                counts_to(self.root / f"calls of {self.name}")
            armed(case, kind, error, nth, lasting)
            return self.command.do(case)

        ended = forked(work, LIMIT)
        if keep:
            self.calls = most_counted(self.root / f"calls of {self.name}")
        out = case / self.command.out
        return ended, set(tree(out)) if out.exists() else set()

    def tried(self, kind: str, error: int, nth: int, lasting: bool) -> str | None:
        """What cannot be explained about one case; None if all is well."""
        ended, there = self._case(kind, error, nth, lasting)
        case, lines = self.root / "case", ended.err.strip().splitlines()
        if ended.hung:
            return "it hangs"
        if ended.code not in self.command.codes:
            return f"ends with {ended.code}: {lines[-1] if lines else ''}"
        if ended.code == 2 and (len(lines) != 1 or not lines[0].startswith("swamp-rl: ")):
            return f"says {len(lines)} lines: {lines[-3:]}"
        if kind not in ("open", "close") and any(hidden in ended.err for hidden in UNFINISHED):
            return f"names what is hidden: {lines[-1]}"  # a file that cannot be read is named where it is
        if "Traceback" in ended.err:
            return f"traceback: {lines[-1]}"
        if tree(case / "inputs") != self.inputs:
            return "its inputs are changed"
        if self.command.check is not None:
            try:
                wrong = self.command.check(case, ended)
            except Exception as error:
                wrong = f"what it left cannot be read: {error}"
            return wrong or self._beside(kind)
        if ended.code == 0 and there != self.whole:
            return f"ends well without {sorted(self.whole - there)[:3]}"
        if there and there != self.whole and self.command.out not in self.command.left:
            return f"leaves a part: without {sorted(self.whole - there)[:3]}"
        return self._beside(kind)

    def _beside(self, kind: str) -> str | None:
        """What is left beside the output that should not be there."""
        case = self.root / "case"
        others = {path.name for path in case.iterdir()} - {"inputs", self.command.out, *self.command.left}
        if kind in ("open", "close"):  # nothing can be removed where a folder cannot be listed
            others = {name for name in others if not name.startswith(UNFINISHED)}
        return f"leaves {sorted(others)}" if others else None

    def places(self, kind: str, most: int, rng: np.random.Generator) -> Iterator[int]:
        """Values of N: the first, the last and others, drawn; none twice."""
        calls = self.calls[kind]
        few = {1, calls, *(1 + rng.permutation(calls)[: max(most - 2, 0)]).tolist()} if calls else set()
        yield from sorted(few)[:most] if most < len(few) else sorted(few)


def warmed(name: str, root: Path) -> None:
    """Do a command once in this process."""
    case = root / "warm"
    shutil.copytree(root / "inputs", case / "inputs")
    with suppress(SystemExit):
        COMMANDS[COMMANDS[name].warmed_by or name].do(case)
    shutil.rmtree(case)


def attacked(name: str, places: int, root: Path) -> Count:
    """The cases tried of one command and those that cannot be explained."""
    rng, cases, unexplained = np.random.default_rng(SEED), 0, []
    warmed(name, root)
    one = Attack(name, root)
    for kind in CALLS:
        for error in ERRORS:
            for nth in one.places(kind, places, rng):
                lasting = bool(rng.integers(2))
                cases += 1
                wrong = one.tried(kind, error, nth, lasting)
                if wrong:
                    at = f"{kind} {nth} of {one.calls[kind]}" + (" and after" if lasting else "")
                    unexplained.append(f"{errno.errorcode[error]} at {at}: {wrong}")
                    print(f"{name}: {unexplained[-1]}", file=sys.stderr, flush=True)
    every = places >= max(one.calls[kind] for kind in CALLS)
    note = "every call" if every else f"at most {places} places of each kind of call"
    return Count("faults", name, cases, unexplained, note)


def attack(asked: Namespace) -> Iterator[Count]:
    """Counts by command, each from a process whose calls are in our hand."""
    for name in COMMANDS:
        if asked.only is None or name in asked.only:
            places = asked.count or (QUICK_PLACES if asked.quick else COMMANDS[name].places)
            yield from with_shim("benchmarks.attack.faults", [name, str(places)])


if __name__ == "__main__":
    parse_once()
    imported()
    with scratch() as root, cheaper():
        prepare(root / "inputs")
        report(attacked(sys.argv[1], int(sys.argv[2]), root))
