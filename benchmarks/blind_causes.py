"""Hide causes in simulated runs, have them diagnosed by a process that sees the files alone, keep the score.

    python -m benchmarks.blind_causes --cases 200 --level A --workers 2 --out blind

Each case is drawn from its own seed and stored, so a run that was stopped goes on where it was. Writes
blind_causes.json, blind_causes.md and two figures into the output folder.
"""

import argparse
import atexit
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, cast

import numpy as np

from benchmarks.blind_score import figures, judged, markdown, summary
from benchmarks.update_readme import between_marks
from tests.hidden_effects import EFFECTS, LEVELS, NOT_IN_GATE_RUNS, draw_case, write_case

# Reads folders of data and of answers, one pair a line; sees nothing else, and says done or what went wrong.
DIAGNOSE = """
import sys, time, numpy
from pathlib import Path
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data import read_trials
from swamp_rl.criticism.diagnose import examine
for line in sys.stdin:
    data, answer = map(Path, line.rstrip().split(chr(9)))
    begun = time.process_time()
    try:
        found = examine(read_trials(data, load_boat("swamp")), None, numpy.random.default_rng(0)).diagnosis
        answer.mkdir(parents=True, exist_ok=True)
        (answer / "diagnosis.json").write_text(found.model_dump_json())
        told = "done"
    except Exception as fault:
        told = repr(fault).replace(chr(10), " ")
    print(time.process_time() - begun, told, sep=chr(9), flush=True)
"""
# of a hundred cases: the library's effects in turn, and what else there is
KINDS = ("single",) * 10 + ("pair",) * 4 + ("clean",) * 3 + ("outside",) * 2 + ("confounded",)


def kind_of(number: int, level: str) -> str:
    """Kinds in a fixed turn, so that any number of cases has its share of each."""
    kind = KINDS[(7 * number) % len(KINDS)]
    return "single" if kind == "confounded" and level == "C" else kind


def effect_of(number: int, level: str) -> tuple[str, ...]:
    """The library's effects in turn for the single ones."""
    names = [name for name in EFFECTS if level != "C" or name not in NOT_IN_GATE_RUNS]
    return (names[(11 * number) % len(names)],)


class Diagnoser:
    """A process that diagnoses one case after another, with one thread."""

    def __init__(self) -> None:
        limited = os.environ | {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", DIAGNOSE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=limited,
        )

    def diagnose(self, data: Path, answer: Path) -> tuple[float, str]:
        """Processor's time [s] taken, and what went wrong, if anything."""
        assert self.process.stdin is not None and self.process.stdout is not None
        print(data.resolve(), answer.resolve(), sep="\t", file=self.process.stdin, flush=True)
        seconds, told = self.process.stdout.readline().rstrip("\n").split("\t")
        return float(seconds), "" if told == "done" else told


workers = threading.local()


def worker() -> Diagnoser:
    """The process of this thread."""
    if not hasattr(workers, "own"):
        workers.own = Diagnoser()
        atexit.register(workers.own.process.terminate)
    return cast(Diagnoser, workers.own)


def run_case(number: int, level: str, out: Path) -> dict[str, Any]:
    """Write one case, have it diagnosed by a process of its own, and judge the answer; kept in a file."""
    name = f"{level}{number:04d}"
    kept = out / "judged" / f"{name}.json"
    if kept.exists():
        return dict(json.loads(kept.read_text()))
    data, answer, truth = out / "data" / name, out / "answers" / name, out / "truth" / f"{name}.json"
    if not truth.exists():
        rng = np.random.default_rng([LEVELS.index(level), number])
        kind = kind_of(number, level)
        case = draw_case(rng, level, kind, effect_of(number, level) if kind == "single" else ())
        shutil.rmtree(data, ignore_errors=True)
        write_case(case, rng, data, truth, velocities=number % 4 != 3)
    seconds, told = worker().diagnose(data, answer)
    found = None if told else json.loads((answer / "diagnosis.json").read_text())
    result = {"case": name} | judged(json.loads(truth.read_text()), found)
    result |= {"error": told, "processor_s": seconds}
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(result))
    return result


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases of the levels asked for and write the score."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=200, help="for each level")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no case is begun")
    parser.add_argument("--level", choices=(*LEVELS, "all"), default="all")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("blind_causes"))
    parser.add_argument("--into", type=Path, help="a document whose table is written anew")
    asked = parser.parse_args(arguments)
    levels = LEVELS if asked.level == "all" else (asked.level,)
    numbers = range(asked.first, asked.first + asked.cases)
    work = [(number, level) for number in numbers for level in levels]
    until = time.monotonic() + 60.0 * asked.minutes

    def one(number: int, level: str) -> dict[str, Any] | None:
        """A case, if there is time."""
        return run_case(number, level, asked.out) if time.monotonic() < until else None

    results = []
    with ThreadPoolExecutor(asked.workers) as pool:
        for result in pool.map(lambda numbered: one(*numbered), work):
            if result is None:
                continue
            results.append(result)
            said = (result["case"], result["kind"], result["truth"], result["verdict"], result["named"])
            print(*said, "right" if result["right"] else "WRONG", flush=True)
    scores = {level: summary([r for r in results if r["level"] == level]) for level in levels}
    written = {"scores": scores, "cases": results}
    (asked.out / "blind_causes.json").write_text(json.dumps(written, indent=1))
    (asked.out / "blind_causes.md").write_text(markdown(scores))
    figures(results, asked.out)
    if asked.into:
        text = asked.into.read_text(encoding="utf-8")
        asked.into.write_text(between_marks(text, "blind causes", markdown(scores)), encoding="utf-8")
    print(markdown(scores))
    print(Counter(result["verdict"] for result in results))


if __name__ == "__main__":
    main()
