"""Checkpoint of DAgger's rounds."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swamp_rl.pilots.arrays import Array, owned
from swamp_rl.pilots.checkpoint import load_checkpoint, readable, save_checkpoint
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.runs import Run, RunMeta


@dataclass
class Rounds:
    """Results of the rounds done."""

    corrected: list[Run] = field(default_factory=list)
    successes: list[int] = field(default_factory=list)
    "In the trials of each round's learner, the one before the first round included."
    learner: Pilot | None = None
    "As it came out of the last round."
    best: Pilot | None = None


def save_rounds(path: Path, rounds: Rounds, task: str) -> None:
    """Replace the checkpoint `path` atomically; UserError where it cannot be written."""
    tensors: dict[str, Array] = {}
    pilots = {}
    for role, pilot in (("learner", rounds.learner), ("best", rounds.best)):
        assert pilot is not None
        pilots[role] = {"kind": pilot.kind, "settings": pilot.settings()}
        tensors |= {f"{role}.{name}": value for name, value in pilot.weights().items()}
    runs = []
    for i, run in enumerate(rounds.corrected):
        runs.append(
            {"name": run.name, "columns": list(run.columns), "meta": run.meta.model_dump(mode="json")}
        )
        tensors |= {f"run {i}.{name}": values for name, values in run.columns.items()}
    description = {"task": task, "successes": rounds.successes, "pilots": pilots, "runs": runs}
    save_checkpoint(path, description, tensors)


def load_rounds(path: Path, task: str) -> Rounds:
    """The rounds that `path` holds; none where there is no such file, or one of another task.

    UserError where it is damaged.
    """
    kept = load_checkpoint(path)
    if kept is None:
        return Rounds()
    description, tensors = kept
    with readable(path):
        if description["task"] != task:
            return Rounds()
        runs = []
        for i, entry in enumerate(description["runs"]):
            columns = {name: tensors[f"run {i}.{name}"] for name in entry["columns"]}
            runs.append(Run(entry["name"], columns, RunMeta.model_validate(entry["meta"])))
        learner, best = (_pilot(role, description["pilots"][role], tensors) for role in ("learner", "best"))
        return Rounds(runs, description["successes"], learner, best)


def _pilot(role: str, entry: dict[str, Any], tensors: dict[str, Array]) -> Pilot:
    from swamp_rl.pilots.store import KINDS

    pilot: Pilot = KINDS[entry["kind"]].build(entry["settings"], owned(role, tensors))
    return pilot
