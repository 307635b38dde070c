"""What each mechanism of the diagnosis is good for: golden cases with it, and without it.

    python -m benchmarks.ablation --minutes 30 --into docs/criticism.md

Every mechanism is switched off through the options alone (`swamp_rl/criticism/options.py`). Each diagnosis is
stored in the folder `--out`, so a run that was stopped goes on where it was. Cases that take longer than
`--longest` with every mechanism are left out. An answer is right where the verdict and the names of the
causes are the truth's, of a missing force where the right variable is among its functions. Times are of a
processor.
"""

import argparse
import itertools
import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import write_parts
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.options import using
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.one_thread import one_thread

GOLDEN = Path(__file__).parents[1] / "tests" / "criticism" / "golden"
WITH = "everything"
OFF: dict[str, dict[str, Any]] = {  # mechanism: the options without it
    WITH: {},
    "command timing": {"most_reconstructions": 0, "reconstruction_hopeless": 0.0},
    "commands in lost rows": {"longest_gap": 0},
    "commands in lost rows alone": {"most_corrections": 0},
    "position wander": {"wander_gain": math.inf},
    "model error": {"model_error_chi2": math.inf},
    "weather run by run": {"most_groups": 1},
    "carry-over": {"judged_horizons": ()},
    "rival margin": {"separation": 0.0},
    "residual force": {"listed_functions": 0},
    "smoothed channels": {"smoothed_step": 0.0},
    "small effects on whole runs": {"small_shortlist": 0},
    "alternatives to the hull's derivatives": {"nuisance_limit": math.inf},
    "exchange of effects": {"exchange_budget": -1.0},
    "restart from half windows": {"converged_share": -math.inf},
    "refit of stray windows": {"stray_window": math.inf, "most_refits": 0},
    "jumps on a part of the windows": {"jump_windows": sys.maxsize},
    "bound on shorter windows": {"clearly": math.inf},
}
POINTED = 4  # missing forces, of which one must go with the right variable


@one_thread()
def diagnosed(case: str, truth: Mapping[str, Any], off: Mapping[str, Any]) -> dict[str, Any]:
    """Whether the answer is right, the processor time [s], and the answer in words."""
    boat = load_boat(GOLDEN / case / truth["boat"] if truth["boat"].endswith(".yaml") else truth["boat"])
    begun = time.process_time()
    with using(**off):
        try:
            run_set = read_run_set(GOLDEN / case, boat)
            refuse_inconsistent(run_set, case)
            found = examine(run_set, None, np.random.default_rng(0)).diagnosis
            right, text = is_right(found, truth), words(found)
        except UserError as error:
            right, text = truth["verdict"] == "refused", str(error)
    return {"right": right, "seconds": time.process_time() - begun, "answer": text}


def is_right(found: Diagnosis, truth: Mapping[str, Any]) -> bool:
    """Whether verdict and names are the truth's."""
    if found.verdict != truth["verdict"]:
        return False
    causes = [cause["effect"] for cause in truth.get("causes", [])]
    wanted = sorted({*causes, *(effect for run in truth.get("by_run", []) for effect in run)})
    if found.verdict == "unexplained":
        variables = {one.variable.replace(" ", "_") for one in found.leftover[:POINTED]}
        return bool(variables & set(truth["outside"]["variables"]))
    if found.verdict == "indistinguishable":
        named = [[part.split()[0] for part in one.split(" + ")] for one in found.indistinguishable[0]]
        return wanted in map(sorted, named)
    return sorted(cause.effect for cause in found.causes) == wanted


def words(found: Diagnosis) -> str:
    """An answer on one line."""
    return f"{found.verdict}: {', '.join(cause.effect for cause in found.causes) or 'none'}"


def rows(results: Mapping[tuple[str, str], Mapping[str, Any]]) -> list[list[str]]:
    """A row for each mechanism that was tried: right answers and time on the same cases with and without."""
    found = []
    for name in OFF:
        mine = [case for which, case in results if which == name and (WITH, case) in results]
        if name == WITH or not mine:
            continue
        with_it, without = ([results[which, case] for case in mine] for which in (WITH, name))
        changed = [
            f"{case}: {less['answer'].replace('_', ' ')}"
            for case, one, less in zip(mine, with_it, without, strict=True)
            if one["answer"] != less["answer"]
        ]
        rights = [str(sum(one["right"] for one in every)) for every in (with_it, without)]
        seconds = [f"{sum(one['seconds'] for one in every):.0f}" for every in (with_it, without)]
        found.append([name, str(len(mine)), *rights, *seconds, "; ".join(changed) or "none"])
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose the cases that are not stored yet while there is time, and write the table."""
    truths = yaml.safe_load((GOLDEN / "golden.yaml").read_text())
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--case", choices=tuple(truths), nargs="+", default=tuple(truths), metavar="NAME")
    parser.add_argument("--longest", type=float, default=8.0, help="seconds of a case with every mechanism")
    mechanisms = tuple(OFF)[1:]
    parser.add_argument("--without", choices=mechanisms, nargs="+", default=mechanisms, metavar="MECHANISM")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which no diagnosis is begun")
    parser.add_argument("--out", type=Path, default=Path("ablation"))
    parser.add_argument("--into", type=Path, help="a document that the table is written into")
    asked = parser.parse_args(arguments)
    until = time.monotonic() + 60.0 * asked.minutes
    results: dict[tuple[str, str], dict[str, Any]] = {}
    compiled = False
    for case, (name, off) in itertools.product(truths, OFF.items()):
        kept = asked.out / name.replace(" ", "_").replace("'", "") / f"{case}.json"
        quick = name == WITH or results.get((WITH, case), {"seconds": math.inf})["seconds"] <= asked.longest
        wanted = case in asked.case and name in (WITH, *asked.without) and quick
        if wanted and not kept.exists() and time.monotonic() < until:
            if not compiled:
                diagnosed("mass", truths["mass"], {})
                compiled = True
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(diagnosed(case, truths[case], off)))
            print(case, "without", name, kept.read_text(), flush=True)
        if kept.exists():
            results[name, case] = json.loads(kept.read_text())
    heads = ("without", "cases", "right with", "right without", "s with", "s without", "other answers")
    text = table(list(heads), rows(results))
    if asked.into:
        write_parts(asked.into, {"ablation": text})
    print(text)


if __name__ == "__main__":
    main()
