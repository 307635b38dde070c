"""How much sooner a diagnosis ends with two threads than with one.

    python -m benchmarks.blind.threads --first 34000 --cases 3 --out blind_threads

Diagnoses cases of levels A to D and one of R with one and with two threads in turn, on an idle machine of two
cores or more, and writes a table of docs/criticism.md. The answers must be the same.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import LEVELS

from benchmarks.blind.arguments import add_numbers
from benchmarks.blind.cases import name_of, written
from benchmarks.blind.diagnose import Diagnoser
from benchmarks.markers import DOCS, write_parts

THREADS = (1, 2)
UNCOMPARED = {"elapsed_s"}


def answer_of(folder: Path) -> dict[str, object]:
    """A diagnosis without its time."""
    found = json.loads((folder / "diagnosis.json").read_text())
    return {key: one for key, one in found.items() if key not in UNCOMPARED}


def timed(cases: Sequence[tuple[int, str]], out: Path) -> list[list[float]]:
    """Wall times [s] of each case with one thread and with two; the first case is diagnosed once before."""
    diagnosers = [Diagnoser(threads) for threads in THREADS]
    made = []
    for number, level in [cases[0], *cases]:
        name, (data, _) = name_of(number, level), written(number, level, out)
        answers = [out / f"threads_{threads}" / name for threads in THREADS]
        pairs = zip(diagnosers, answers, strict=True)
        made.append([diagnoser.wall_time(data, answer, "swamp") for diagnoser, answer in pairs])
        if answer_of(answers[0]) != answer_of(answers[1]):
            raise SystemExit(f"{name}: another answer with two threads; see {answers[1]}")
        print(name, *(f"{one:.1f} s" for one in made[-1]), flush=True)
    for one in diagnosers:
        one.process.terminate()
    return made[1:]


def main(arguments: Sequence[str] | None = None) -> None:
    """Time the cases and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    add_numbers(parser, 3)
    parser.add_argument("--out", type=Path, default=Path("blind_threads"))
    asked = parser.parse_args(arguments)
    numbers = range(asked.first, asked.first + asked.cases)
    every = [(number, level) for level in LEVELS for number in numbers]
    made = np.array(timed([*every, (asked.first, "R")], asked.out))
    rows = []
    for name, some in (("A to D", made[:-1]), ("R", made[-1:])):
        ratio = some[:, 0] / some[:, 1]
        spread = f"{np.median(ratio):.2f}"
        spread += f" ({ratio.min():.2f} to {ratio.max():.2f})" if len(ratio) > 1 else ""
        rows.append([name, str(len(some)), *(f"{one:.1f}" for one in np.median(some, axis=0)), spread])
    heads = ["level", "cases", "one thread, median s", "two threads, median s", "ratio, median (range)"]
    write_parts(DOCS / "criticism.md", {"blind threads": table(heads, rows)})


if __name__ == "__main__":
    main()
