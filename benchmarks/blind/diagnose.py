"""Hide causes in simulated runs, have them diagnosed by a process that sees the files alone, keep the score.

    python -m benchmarks.blind.diagnose --cases 200 --level A --workers 2 --out blind
    python -m benchmarks.blind.diagnose --score-only blind --into docs/criticism.md

Each case is drawn from its own seed and stored, so a run that was stopped goes on where it was, and what is
done can be scored at any time. Writes blind_causes.json, blind_causes.md and two figures into the output
folder, or into a document and beside it. Levels A to D are the four that have bars; E is A with another wind
or current in each run, alone or beside one effect; P is A with faults down to nothing, for the power of
detection; T is A with three effects; X is other boats, manoeuvres, rates and noise; R is sailed by another
simulator, its curves off by 3 %, under random forces.
"""

import argparse
import atexit
import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, cast

from swamp_rl.experiments.synthetic.cases import LEVELS, POWER

from benchmarks.blind.arguments import add_evidence, add_numbers
from benchmarks.blind.cases import (
    KINDS,
    SEEDS,
    every_score,
    evidence_of,
    kind_of,
    name_of,
    scored,
    written,
)
from benchmarks.blind.tables import parts, pictures
from benchmarks.blind.variants import VARIANT
from benchmarks.markers import write_parts

# Reads folders of data and of answers and a boat's name, three a line; sees nothing else, and says done or
# what went wrong.
DIAGNOSE = """
import sys, time, traceback, numpy
from pathlib import Path
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.data.consistency import refuse_inconsistent
for line in sys.stdin:
    data, answer, boat = line.rstrip().split(chr(9))
    begun = time.process_time()
    try:
        run_set = read_run_set(Path(data), load_boat(boat))
        refuse_inconsistent(run_set, data)
        found = examine(run_set, None, numpy.random.default_rng(0)).diagnosis
        Path(answer).mkdir(parents=True, exist_ok=True)
        (Path(answer) / "diagnosis.json").write_text(found.model_dump_json())
        ended = "done"
    except Exception as fault:
        place = traceback.extract_tb(fault.__traceback__)[-1]
        ended = f"{fault!r} in {place.name}".replace(chr(10), " ")
    print(time.process_time() - begun, ended, sep=chr(9), flush=True)
"""


class Diagnoser:
    """A process that diagnoses one case after another; threads: of its simulations."""

    def __init__(self, threads: int = 1) -> None:
        limited = os.environ | {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": str(threads)}
        self.process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", DIAGNOSE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=limited,
        )

    def diagnose(self, data: Path, answer: Path, boat: str) -> tuple[float, str]:
        """Processor time [s], and the fault, if any."""
        assert self.process.stdin is not None and self.process.stdout is not None
        print(data.resolve(), answer.resolve(), boat, sep="\t", file=self.process.stdin, flush=True)
        seconds, message = self.process.stdout.readline().rstrip("\n").split("\t")
        return float(seconds), "" if message == "done" else message

    def wall_time(self, data: Path, answer: Path, boat: str) -> float:
        """Wall time [s] of a diagnosis; SystemExit at a fault."""
        begun = time.perf_counter()
        _, fault = self.diagnose(data, answer, boat)
        if fault:
            raise SystemExit(f"{data.name}: {fault}")
        return time.perf_counter() - begun


workers = threading.local()


def worker() -> Diagnoser:
    """The process of this thread."""
    if not hasattr(workers, "own"):
        workers.own = Diagnoser()
        atexit.register(workers.own.process.terminate)
    return cast(Diagnoser, workers.own)


def run_case(number: int, level: str, out: Path) -> dict[str, Any]:
    """Write one case, diagnose it in a process of its own, and store the result in a file."""
    name = name_of(number, level)
    kept = out / "judged" / f"{name}.json"
    if not kept.exists():
        data, truth = written(number, level, out)
        boat = json.loads(truth.read_text()).get("boat", "swamp")
        seconds, message = worker().diagnose(data, out / "answers" / name, boat)
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps({"case": name, "error": message, "processor_s": seconds}))
    return scored(out, name)


def time_again(out: Path, least: float) -> None:
    """Diagnose again, alone and with two threads, the cases that took at least `least` seconds of a
    processor; the wall time is stored, the answers are kept.
    """
    slow = [path for path in sorted((out / "judged").glob("*.json")) if _processor(path) >= least]
    both = Diagnoser(threads=2)
    for path in slow[:1] + slow:  # the first one twice, since it compiles
        boat = json.loads((out / "truth" / path.name).read_text()).get("boat", "swamp")
        seconds = both.wall_time(out / "data" / path.stem, out / "again" / path.stem, boat)
        kept = json.loads(path.read_text()) | {"alone_s": seconds}
        path.write_text(json.dumps(kept))
        print(path.stem, f"{kept['processor_s']:.1f} s of a core, {kept['alone_s']:.1f} s alone", flush=True)
    both.process.terminate()


def _processor(path: Path) -> float:
    return float(json.loads(path.read_text())["processor_s"] or 0.0)


def asked_for() -> argparse.ArgumentParser:
    """What the command takes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    add_numbers(parser, 200)
    parser.add_argument(
        "--level", choices=(*SEEDS, "all"), default="all", help="all: A to D, so many of each"
    )
    parser.add_argument(
        "--kind", choices=sorted({*KINDS, "triple"}), help="only those of the numbers (not of level X)"
    )
    add_evidence(parser)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("blind_causes"))
    parser.add_argument(
        "--score-only", type=Path, nargs="+", metavar="FOLDER", help="diagnose nothing, score what these hold"
    )
    parser.add_argument(
        "--again", type=float, metavar="SECONDS", help="time slower ones of --out again, alone on two cores"
    )
    parser.add_argument("--into", type=Path, help="a document that the tables are written into")
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases of the chosen levels, and write the results of all that the folder holds."""
    parser = asked_for()
    asked = parser.parse_args(arguments)
    if asked.kind and asked.level == VARIANT:
        parser.error("argument --kind: a case of level X has the kind that it draws; leave --kind out")
    folders = asked.score_only or [asked.out]
    if asked.again is not None:
        time_again(asked.out, asked.again)
    elif not asked.score_only:
        diagnose_all(chosen(asked), asked)
    results = [r for folder in folders for r in every_score(folder)]
    if not results:
        raise SystemExit(f"{', '.join(map(str, folders))}: no judged case; run some without --score-only")
    tables = parts(results)
    text = "\n\n".join(f"## {name}\n\n{body}" for name, body in tables.items()) + "\n"
    (folders[0] / "blind_causes.json").write_text(json.dumps(results, indent=1))
    (folders[0] / "blind_causes.md").write_text(text)
    pictures(results, asked.into.parent if asked.into else folders[0])
    if asked.into:
        write_parts(asked.into, tables)
    print(text)
    print(Counter(result["verdict"] for result in results))


def chosen(asked: argparse.Namespace) -> list[tuple[int, str]]:
    """Number and level of every case that is asked for."""
    levels = LEVELS if asked.level == "all" else (asked.level,)
    numbers = range(asked.first, asked.first + asked.cases)
    every = [(number, level) for number in numbers for level in levels]
    return [one for one in every if asked.kind in (None, kind_of(*one))]


def diagnose_all(work: Sequence[tuple[int, str]], asked: argparse.Namespace) -> None:
    """Run cases in parallel while there is time."""
    until = time.monotonic() + 60.0 * asked.minutes

    def one(numbered: tuple[int, str]) -> dict[str, Any] | None:
        """A case, if there is time and it is asked for."""
        number, level = numbered
        if time.monotonic() > until:
            return None
        low, high = asked.evidence
        if level == POWER and not low <= evidence_of(asked.out, number) < high:
            return None
        return run_case(number, level, asked.out)

    with ThreadPoolExecutor(asked.workers) as pool:
        for result in filter(None, pool.map(one, work)):
            line = (result["case"], result["kind"], result["truth"], result["verdict"], result["named"])
            print(*line, "right" if result["right"] else "WRONG", flush=True)


if __name__ == "__main__":
    main()
