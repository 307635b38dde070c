"""The blind cases by number: how each is drawn, and its result from the stored files."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import (
    EACH_RUN,
    EFFECTS,
    LEVELS,
    NOT_BESIDE_WEATHER,
    NOT_IN_GATE_RUNS,
    POWER,
    ROUGH,
    TRIPLE,
    Case,
    Rng,
    draw_case,
    write_case,
)

from benchmarks.blind.bound import Bound, bound_of
from benchmarks.blind.classifier import Rates, classifier_rates
from benchmarks.blind.rough_simulator import rough_voyages
from benchmarks.blind.score import Judged, judged
from benchmarks.blind.true_set import criterion_of_truth
from benchmarks.blind.variants import VARIANT, write_variant

SEEDS = (*LEVELS, POWER, VARIANT, EACH_RUN, ROUGH, TRIPLE)
"""The levels; a case is drawn from its level's place here and its number."""
# of a hundred cases: the library's effects in turn, and what else there is
KINDS = ("single",) * 10 + ("pair",) * 4 + ("clean",) * 3 + ("outside",) * 2 + ("confounded",)
# effects whose size is discrete, or has no neutral value
NEVER_SMALL = (
    "channel_swap",
    "azimuth_reversed",
    "throttle_reversed",
    "thruster_failure",
    "shallow_water",
)
# effects that the classifier's linear problem does not hold for
NOT_LINEAR = ("waves",)


def kind_of(number: int, level: str) -> str:
    """Kinds in a fixed cycle, so that any number of cases has its share of each."""
    if level == POWER:
        return "single"
    if level == TRIPLE:
        return "triple"
    if level == ROUGH:  # two in three have an effect
        return "clean" if number % 3 == 2 else "single"
    if level == EACH_RUN:  # the weather alone, or beside one effect
        return "single" if number % 4 == 0 else "pair"
    kind = KINDS[(7 * number) % len(KINDS)]
    return "single" if kind == "confounded" and level == "C" else kind


def effect_of(number: int, level: str) -> tuple[str, ...]:
    """The effect of a single-effect case, the library's in a cycle."""
    without = {"C": NOT_IN_GATE_RUNS, POWER: NEVER_SMALL, EACH_RUN: NOT_BESIDE_WEATHER}.get(level, ())
    names = [name for name in EFFECTS if name not in without]
    return (names[(11 * number) % len(names)],)


def drawn(number: int, level: str) -> tuple[Case, Rng, bool]:
    """A case of every level but X, the generator that draws its runs, and whether velocities are
    measured.
    """
    rng = np.random.default_rng([SEEDS.index(level), number])
    kind = kind_of(number, level)
    one = kind == ("pair" if level == EACH_RUN else "single")
    case = draw_case(rng, level, kind, effect_of(number, level) if one else ())
    return case, rng, number % 4 != 3 and level != "B"


def write_numbered(number: int, level: str, data: Path, truth: Path) -> None:
    """Simulate a case; write its runs into the folder `data`, its causes into the file `truth`."""
    if level == VARIANT:
        write_variant(np.random.default_rng([SEEDS.index(level), number]), data, truth)
        return
    case, rng, velocities = drawn(number, level)
    sailed = rough_voyages if level == ROUGH else None
    write_case(case, rng, data, truth, velocities=velocities, sailed=sailed)


def name_of(number: int, level: str) -> str:
    """Of a case, and of its files."""
    return f"{level}{number:04d}"


def written(number: int, level: str, out: Path) -> tuple[Path, Path]:
    """The folder of a case's runs and the file of its causes in `out`, simulated unless they are there."""
    name = name_of(number, level)
    data, truth = out / "data" / name, out / "truth" / f"{name}.json"
    if not truth.exists():
        shutil.rmtree(data, ignore_errors=True)
        write_numbered(number, level, data, truth)
    return data, truth


def every_score(folder: Path) -> list[dict[str, Any]]:
    """Results of all cases that the folder has an answer of."""
    return [scored(folder, path.stem) for path in sorted((folder / "judged").glob("*.json"))]


def scored(folder: Path, name: str) -> dict[str, Any]:
    """The result of a diagnosed case, from its truth and its answer, with its Cramér-Rao bound."""
    data = json.loads((folder / "judged" / f"{name}.json").read_text())
    truth = json.loads((folder / "truth" / f"{name}.json").read_text())
    answer = folder / "answers" / name / "diagnosis.json"
    found = None if data["error"] else json.loads(answer.read_text())
    result = {key: data.get(key) for key in ("case", "error", "processor_s", "alone_s")} | judged(
        truth, found
    )
    bound = kept_bound(folder, name, truth) if result["estimates"] or truth["level"] == POWER else None
    least = dict(zip(map(tuple, bound.names), bound.deviation, strict=True)) if bound else {}
    result["truth_over_answer"] = kept_criterion(folder, name, truth, found) if is_wrong_set(result) else None
    for number in result["estimates"]:
        number["bound"] = least.get((number["effect"], number["parameter"]))
    if truth["level"] != POWER or bound is None:
        return result | {"evidence": None, "best_rate": None}
    best = kept_rates(folder, name)
    return result | {"evidence": bound.evidence, "best_rate": best.among_three if best else None}


def is_wrong_set(result: Judged) -> bool:
    """Whether effects were to be named and other ones were, none included."""
    sets = result["kind"] in ("single", "pair", "triple", "clean")
    return sets and not result["right"] and result["verdict"] != "failed"


def kept_criterion(folder: Path, name: str, truth: Judged, found: Judged) -> float | None:
    """How far the criterion of the truth is above the answer's, from its file if it exists; None without the
    runs.
    """
    path = folder / "criteria" / f"{name}.json"
    if not path.exists():
        if not (folder / "data" / name).exists():
            return None
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(criterion_of_truth(folder / "data" / name, truth, found)))
    data: float | None = json.loads(path.read_text())
    return data


def kept_rates(folder: Path, name: str) -> Rates | None:
    """The Bayes classifier's rates of a case of level P, from their file if it exists; None of an effect
    that it has no derivative of.
    """
    case, rng, velocities = drawn(int(name[1:]), name[0])
    if case.names[0] in NOT_LINEAR:
        return None
    path = folder / "classifier" / f"{name}.json"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(vars(classifier_rates(case, rng, velocities))))
    return Rates(**json.loads(path.read_text()))


def evidence_of(folder: Path, number: int) -> float:
    """Evidence of a case of level P, before it is diagnosed, in least standard errors."""
    path = folder / "bounds" / f"{name_of(number, POWER)}.json"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(vars(bound_of(*drawn(number, POWER)))))
    return Bound(**json.loads(path.read_text())).evidence


def kept_bound(folder: Path, name: str, truth: Judged) -> Bound | None:
    """The bound, from its file if it exists; None for a case that is not what its number draws, or whose
    errors are not white.
    """
    level, number = name[0], int(name[1:])
    if level in (VARIANT, ROUGH) or truth["kind"] == "confounded":
        return None
    path = folder / "bounds" / f"{name}.json"
    if not path.exists():
        case, rng, velocities = drawn(number, level)
        if json.loads(json.dumps(vars(case))) != truth:
            return None
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(vars(bound_of(case, rng, velocities))))
    return Bound(**json.loads(path.read_text()))
