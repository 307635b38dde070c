"""Checkpoint of DAgger's rounds: a safetensors file with JSON in its header."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.json_text import parsed_json
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.runs import Run, RunMeta
from swamp_rl.seal import BLANK, KEY, sealed, sealed_file
from swamp_rl.tensors_file import tensors_in


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
    from safetensors.numpy import save

    tensors: dict[str, Array] = {}
    pilots = {}
    for role, pilot in (("learner", rounds.learner), ("best", rounds.best)):
        assert pilot is not None
        pilots[role] = {"kind": pilot.kind, "settings": pilot.settings()}
        tensors |= {f"{role}/{name}": value for name, value in pilot.weights().items()}
    runs = []
    for i, run in enumerate(rounds.corrected):
        runs.append(
            {"name": run.name, "columns": list(run.columns), "meta": run.meta.model_dump(mode="json")}
        )
        tensors |= {f"run {i}/{name}": values for name, values in run.columns.items()}
    said = {"task": task, "successes": rounds.successes, "pilots": pilots, "runs": runs}
    whole = {name: np.ascontiguousarray(value) for name, value in tensors.items()}
    with write_beside(path) as part:
        part.write_bytes(sealed(save(whole, metadata={"rounds": json.dumps(said), KEY: BLANK})))


def load_rounds(path: Path, task: str) -> Rounds:
    """The rounds that `path` holds; none where there is no such file, or one of another task.

    UserError where it is damaged.
    """
    from safetensors.numpy import load

    if not path.exists():
        return Rounds()
    data = sealed_file(path, "remove it")
    try:
        told, tensors = tensors_in(data, load)
        said = parsed_json(told["rounds"])
        if said["task"] != task:
            return Rounds()
        runs = []
        for i, entry in enumerate(said["runs"]):
            columns = {name: tensors[f"run {i}/{name}"] for name in entry["columns"]}
            runs.append(Run(entry["name"], columns, RunMeta.model_validate(entry["meta"])))
        learner, best = (_pilot(role, said["pilots"][role], tensors) for role in ("learner", "best"))
        return Rounds(runs, said["successes"], learner, best)
    except (LookupError, TypeError, AttributeError, ValueError) as error:
        raise UserError(f"{path}: is no checkpoint of DAgger's rounds ({error}); remove it") from error


def _pilot(role: str, entry: dict[str, Any], tensors: dict[str, Array]) -> Pilot:
    from swamp_rl.pilots.store import KINDS

    own = {
        name.removeprefix(f"{role}/"): value for name, value in tensors.items() if name.startswith(f"{role}/")
    }
    pilot: Pilot = KINDS[entry["kind"]].build(entry["settings"], own)
    return pilot
