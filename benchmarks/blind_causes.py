"""Hide causes in simulated runs, have them diagnosed by a process that sees the files alone, keep the score.

    python -m benchmarks.blind_causes --cases 200 --level A --workers 2 --out blind

Each case is drawn from its own seed and stored, so a run that was stopped goes on where it was. Writes
blind_causes.json, blind_causes.md and two figures into the output folder.
"""

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.blind_score import figures, judged, markdown, summary
from tests.hidden_effects import EFFECTS, LEVELS, NOT_IN_GATE_RUNS, draw_case, write_case

DIAGNOSE = (
    "import sys; from pathlib import Path; from swamp_rl.criticism.diagnose import diagnose; "
    "diagnose(Path(sys.argv[1]), 'swamp', Path(sys.argv[2]))"
)
LIMIT = 900.0  # s, many times what a case may take
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


def run_case(number: int, level: str, out: Path) -> dict[str, Any]:
    """Write one case, have it diagnosed in a process of its own, and judge the answer; kept in a file."""
    name = f"{level}{number:04d}"
    kept = out / "judged" / f"{name}.json"
    if kept.exists():
        return dict(json.loads(kept.read_text()))
    data, answer, truth = out / "data" / name, out / "answers" / name, out / "truth" / f"{name}.json"
    if not truth.exists():
        rng = np.random.default_rng([LEVELS.index(level), number])
        kind = kind_of(number, level)
        case = draw_case(rng, level, kind, effect_of(number, level) if kind == "single" else ())
        write_case(case, rng, data, truth, velocities=number % 4 != 3)
    told = ""
    if not (answer / "diagnosis.json").exists():
        command = [sys.executable, "-c", DIAGNOSE, str(data.resolve()), str(answer.resolve())]
        limited = os.environ | {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, env=limited)
            told = done.stderr[-2000:] if done.returncode else ""
        except subprocess.TimeoutExpired:
            told = f"stopped after {LIMIT:.0f} s"
    found = None if told else json.loads((answer / "diagnosis.json").read_text())
    result = {"case": name} | judged(json.loads(truth.read_text()), found) | {"error": told}
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(result))
    return result


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases of the levels asked for and write the score."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=200, help="for each level")
    parser.add_argument("--level", choices=(*LEVELS, "all"), default="all")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("blind_causes"))
    asked = parser.parse_args(arguments)
    levels = LEVELS if asked.level == "all" else (asked.level,)
    work = [(number, level) for number in range(asked.cases) for level in levels]
    results = []
    with ThreadPoolExecutor(asked.workers) as pool:
        for result in pool.map(lambda one: run_case(one[0], one[1], asked.out), work):
            results.append(result)
            said = (result["case"], result["kind"], result["truth"], result["verdict"], result["named"])
            print(*said, "right" if result["right"] else "WRONG", flush=True)
    scores = {level: summary([r for r in results if r["level"] == level]) for level in levels}
    written = {"scores": scores, "cases": results}
    (asked.out / "blind_causes.json").write_text(json.dumps(written, indent=1))
    (asked.out / "blind_causes.md").write_text(markdown(scores))
    figures(results, asked.out)
    print(markdown(scores))
    print(Counter(result["verdict"] for result in results))


if __name__ == "__main__":
    main()
