"""Stated rate of the self-trial against the share of blind cases that are right.

    python -m benchmarks.self_trial --level P --first 500 --cases 60 --evidence 6 30 --out trials
    python -m benchmarks.self_trial --score-only --out trials --into docs/criticism.md

Every case is drawn as in `benchmarks.blind`, searched and tried once, and stored: a run that was stopped
goes on where it was. A case is right where the effects of the best explanation, minor ones among them, are
those that were hidden. Linearised twins are counted.
"""

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import POWER

from benchmarks.blind.arguments import add_evidence, add_numbers
from benchmarks.blind.cases import SEEDS, evidence_of, kind_of, name_of, written
from benchmarks.blind.score import names_in, share
from benchmarks.markers import write_parts
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.inference.self_trial import NOTHING, UNEXPLAINED, causes_in, twin_answers
from swamp_rl.criticism.selection.model_selection import select_model
from swamp_rl.criticism.selection.preparation import prepared
from swamp_rl.one_thread import one_thread

TRIED = ("single", "pair", "triple", "clean", "confounded")  # kinds whose truth is in the library
BINS = (0.0, 0.5, 0.8, 0.95, 1.0)  # of the stated rate
HEADS = ("answers", "stated rate", "cases", "mean stated rate", "of twins with a cause", "right")


def run_case(number: int, level: str, out: Path) -> dict[str, Any]:
    """Write one case, diagnose it, try its answer, and store what came of it."""
    name = name_of(number, level)
    kept = out / "tried" / f"{name}.json"
    if kept.exists():
        return dict(json.loads(kept.read_text()))
    data, truth = written(number, level, out)
    hidden = json.loads(truth.read_text())
    run_set = read_run_set(data, load_boat(hidden.get("boat", "swamp")))
    known = prepared(run_set)
    begun = time.process_time()
    with one_thread(), np.errstate(over="ignore", invalid="ignore"):
        _, continuation, found = select_model(run_set, known.weight, known.instances, known.hull)
        searched = time.process_time()
        answers = twin_answers(run_set, continuation, found) if found.adequate else []
    result = {
        "case": name,
        "kind": hidden["kind"],
        "truth": true_names(hidden),
        "answer": causes_in(found.winner.hypothesis.label) if found.adequate else UNEXPLAINED,
        "twins": [causes_in(answer) for answer in answers],
        "search_s": searched - begun,
        "self_trial_s": time.process_time() - searched,
    }
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(result))
    return result


def true_names(hidden: Mapping[str, Any]) -> list[str]:
    """The hidden effects in order, one that every run has another of named once."""
    own = {effect["effect"] for run in hidden.get("by_run", ()) for effect in run}
    return sorted([*(effect["effect"] for effect in hidden["effects"]), *own])


def is_right(result: Mapping[str, Any]) -> bool:
    """Whether the answer has the hidden effects and no other."""
    return sorted(names_in(result["answer"])) == result["truth"]


def stated(result: Mapping[str, Any]) -> float:
    """Share of the twins that have the same answer."""
    return float(np.mean([one == result["answer"] for one in result["twins"]] or [0.0]))


def stated_of_named(result: Mapping[str, Any]) -> float:
    """The same, of the twins in which a cause was named."""
    named = [one == result["answer"] for one in result["twins"] if one != NOTHING]
    return float(np.mean(named)) if named else 0.0


def calibration(results: Sequence[Mapping[str, Any]]) -> str:
    """A row for each bin of the stated rate of answers with a cause, one for all, one for answers without."""
    tried = [one for one in results if one["twins"]]
    causes = [one for one in tried if one["answer"] != NOTHING]
    rows = []
    for low, high in pairwise(BINS):
        top = high == BINS[-1]
        mine = [one for one in causes if low <= stated(one) < high or (top and stated(one) == high)]
        rows.append(row_of("a cause", f"{low:g} to {high:g}", mine))
    rows.append(row_of("a cause", "all", causes))
    for kind, label in (("clean", "nothing, of nothing wrong"), ("", "nothing, of a hidden effect")):
        mine = [one for one in tried if one["answer"] == NOTHING and (one["kind"] == "clean") == bool(kind)]
        rows.append(row_of(label, "all", mine))
    return table(list(HEADS), [row for row in rows if row[2] != "0"])


def row_of(what: str, rates: str, mine: Sequence[Mapping[str, Any]]) -> list[str]:
    """Of some cases: mean stated rates, and the share that is right with Wilson's 95 % interval."""
    right = share([is_right(one) for one in mine])
    if right is None:
        return [what, rates, "0", "-", "-", "-"]
    return [
        what,
        rates,
        str(len(mine)),
        f"{np.mean([stated(one) for one in mine]):.2f}",
        "-" if mine[0]["answer"] == NOTHING else f"{np.mean([stated_of_named(one) for one in mine]):.2f}",
        f"{right['rate']:.2f} ({right['low']:.2f} to {right['high']:.2f})",
    ]


def asked_for() -> argparse.ArgumentParser:
    """What the command takes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--level", choices=SEEDS, default=POWER)
    add_numbers(parser, 60, first=500)
    add_evidence(parser)
    parser.add_argument("--out", type=Path, default=Path("self_trials"))
    parser.add_argument("--score-only", action="store_true", help="diagnose nothing, score what --out holds")
    parser.add_argument("--into", type=Path, help="a document that the table is written into")
    return parser


def main() -> None:
    """Run the cases that are asked for; write the table of all that the folder holds."""
    asked = asked_for().parse_args()
    until = time.monotonic() + 60.0 * asked.minutes
    low, high = asked.evidence
    for number in () if asked.score_only else range(asked.first, asked.first + asked.cases):
        if time.monotonic() > until:
            break
        if kind_of(number, asked.level) not in TRIED:
            continue
        if asked.level == POWER and not low <= evidence_of(asked.out, number) < high:
            continue
        one = run_case(number, asked.level, asked.out)
        print(one["case"], one["truth"], one["answer"], f"{stated(one):.2f}", flush=True)
    results = [json.loads(path.read_text()) for path in sorted((asked.out / "tried").glob("*.json"))]
    if not results:
        raise SystemExit(f"{asked.out}: no case was tried; run some without --score-only")
    times = [np.median([one[key] for one in results]) for key in ("search_s", "self_trial_s")]
    text = calibration(results)
    print(text, f"processor s, median: {times[0]:.1f} search, {times[1]:.1f} self-trial", sep="\n\n")
    if asked.into:
        write_parts(asked.into, {"self trial": text})


if __name__ == "__main__":
    main()
