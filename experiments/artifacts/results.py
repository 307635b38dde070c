"""`results.json`: what was measured, compared and reached."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from itertools import combinations
from typing import Any

import numpy as np
from swamp_rl.experiments.config.learners import learner
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan, Targets

from swamp_rl.errors import UserError
from swamp_rl.evaluation import Interval, Table, command_change, differences, summary
from swamp_rl.runs import Dataset, Run

Tables = Mapping[tuple[str, str], Table]
"""Episodes by pilot and level."""


def gather(scene: Scene, dataset: Dataset, tables: Tables) -> dict[str, Any]:
    """All of results.json but what was measured of the job itself."""
    experiment = scene.experiment
    kinds = [learner(plan.kind) for plan in experiment.pilots.values()]
    data = data_results(dataset) | {"trained_on": any(one.from_runs or one.by_trying for one in kinds)}
    levels = pilot_results(tables)
    return {
        "name": experiment.name,
        "description": experiment.description,
        "boat": scene.boat.name,
        "course": scene.course.name,
        "evaluation": {
            "levels": list(scene.levels),
            "episodes": experiment.evaluation.episodes,
            "seed": experiment.evaluation.seed,
            "shown": min(experiment.evaluation.shown, experiment.evaluation.episodes),
        },
        "data": data,
        "pilots": {
            name: {"kind": plan.kind, "learned_from": learned_from(plan), "levels": levels[name]}
            for name, plan in experiment.pilots.items()
        },
        "targets": target_results(experiment.targets, levels, data["command_change"]),
        "differences": difference_results(tables, np.random.default_rng(experiment.evaluation.seed)),
    }


def learned_from(plan: PilotPlan) -> str:
    """In words, what a pilot learned from; empty where it learned nothing."""
    learned = learner(plan.kind).description(plan)
    if not learned or plan.takeover == 0.0:
        return learned
    return f"{learned}; the scripted pilot drives for the first {plan.takeover:g} s, then it takes over"


def data_results(dataset: Dataset) -> dict[str, Any]:
    """What there was to learn from; the change of command is the mean over the successful runs.

    UserError where no run is successful, or one has no commands of a joypad.
    """
    good = dataset.successful
    if not good:
        raise UserError(
            f"{dataset.folder}: no run is marked successful, and pilots are compared with such runs; record "
            "one that passes every gate, or import runs with --outcome success"
        )
    return {
        "source": dataset.meta.source,
        "vehicle": dataset.meta.vehicle,
        "runs": len(dataset.runs),
        "successful": len(good),
        "outcomes": dict(Counter(run.meta.outcome or "not recorded" for run in dataset.runs)),
        "minutes": sum(run.duration for run in good) / 60.0,
        "command_change": mean_command_change(good),
    }


def mean_command_change(runs: Iterable[Run]) -> float:
    """Mean over runs of their mean change of command per step [1]."""
    return float(np.mean([command_change(run.joypad) for run in runs]))


def pilot_results(tables: Tables) -> dict[str, dict[str, Any]]:
    """Summaries by pilot, then by level."""
    results: dict[str, dict[str, Any]] = {}
    for (pilot, level), table in tables.items():
        results.setdefault(pilot, {})[level] = summary(table)
    return results


def difference_results(tables: Tables, rng: np.random.Generator) -> list[dict[str, Any]]:
    """Every pair of pilots at every level, with paired intervals."""
    pilots = list(dict.fromkeys(pilot for pilot, _ in tables))
    levels = list(dict.fromkeys(level for _, level in tables))
    return [
        {"level": level, "a": a, "b": b}
        | {what: _span(found) for what, found in differences(tables[a, level], tables[b, level], rng).items()}
        for level in levels
        for a, b in combinations(pilots, 2)
    ]


def _span(found: Interval) -> dict[str, Any]:
    """As JSON has it: null without a pair to compare, and as the ends of a single one."""
    return {key: None if math.isnan(number) else number for key, number in asdict(found).items()}


def target_results(
    targets: Targets, pilots: Mapping[str, Mapping[str, Mapping[str, Any]]], data_change: float
) -> list[dict[str, Any]]:
    """Each target with what was measured and whether it was reached.

    A pilot is smoother than the data where its command changes less per step at every level that is asked of
    its success (at every level, if none is).
    """
    found = []
    for pilot, by_level in targets.success.items():
        for level, needed in by_level.items():
            measured = pilots[pilot][level]["success_rate"]
            found.append(_target("success", pilot, level, needed, measured))
    for pilot in targets.smoother_than_data:
        for level in targets.success.get(pilot, pilots[pilot]):
            change = pilots[pilot][level]["mean_of_successes"]["command_change"]
            found.append(_target("smoothness", pilot, level, data_change, change))
    return found


def _target(what: str, pilot: str, level: str, needed: float, measured: float | None) -> dict[str, Any]:
    """what: `success`, at least what is needed, or `smoothness`, a change of command below what is."""
    reached = measured is not None and (measured >= needed if what == "success" else measured < needed)
    which = {"what": what, "pilot": pilot, "level": level}
    return which | {"needed": needed, "measured": measured, "reached": reached}
