"""Trials that differ only in seeds, taken together: what a setting gives over several trainings."""

from collections.abc import Mapping, Sequence
from typing import Any

from swamp_rl.experiments.sweep.schema import Sweep


def over_seeds(sweep: Sweep, trials: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """For each combination of the values that are no seeds, the best first: `values`, `seeds` (how many
    trials have a summary), and the mean, the least and the greatest of `success` and of the objective's
    `value` over them, None where no trial has one.

    Empty where no parameter is a seed, or none is anything else, or no setting has trials of two seeds.
    """
    settings = [key for key in sweep.parameters if not _is_seed(key)]
    if not settings or len(settings) == len(sweep.parameters):
        return []
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for trial in trials:
        if trial["summary"] is not None:
            groups.setdefault(repr([trial["values"][key] for key in settings]), []).append(trial)
    if all(len(group) < 2 for group in groups.values()):
        return []
    found = [
        {
            "values": {key: group[0]["values"][key] for key in settings},
            "seeds": len(group),
            "success": _spread([trial["summary"]["success_rate"] for trial in group]),
            "value": _spread([trial["value"] for trial in group if trial["value"] is not None]),
        }
        for group in groups.values()
    ]
    return sorted(found, key=lambda one: _rank(sweep, one), reverse=True)


def _is_seed(key: str) -> bool:
    return key.rpartition(".")[2] == "seed"


def _spread(numbers: Sequence[float]) -> dict[str, float] | None:
    if not numbers:
        return None
    return {"mean": sum(numbers) / len(numbers), "least": min(numbers), "greatest": max(numbers)}


def _rank(sweep: Sweep, setting: Mapping[str, Any]) -> tuple[bool, float]:
    value = setting["value"]
    summary = {"success_rate": setting["success"]["mean"]}
    return sweep.objective.rank(None if value is None else value["mean"], summary)
