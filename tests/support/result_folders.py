"""Folders of results with chosen outcomes."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import yaml

from swamp_rl.evaluation import write_episodes

KINDS = {"reservoir": "reservoir", "ppo": "ppo", "clone-1": "cloning", "clone-2": "cloning"}
"""Of the pilots, by name."""


def folder_of(
    path: Path,
    success: dict[str, Any],
    seed: int = 0,
    first: int = 100,
    course: str = "camogli",
    ridge: float = 3.0,
    electric: bool = False,
    seeds: Mapping[str, int] = MappingProxyType({}),
) -> Path:
    """A folder of results in which each pilot of `success` succeeded so (n,) at `calm`.

    electric: with the costs of a boat that has a battery. seeds: of pilots not trained by `seed`.
    """
    pilots = {
        name: {"kind": KINDS[name], "options": {"seed": seeds.get(name, seed), "ridge": ridge}}
        for name in success
    }
    experiment = {"name": "small", "boat": "swamp", "course": course, "step": 0.1, "pilots": pilots}
    for what in ("boats", "courses"):
        (path / "config" / what).mkdir(parents=True)
    (path / "config" / "experiment.yaml").write_text(yaml.safe_dump(experiment))
    (path / "config" / "courses" / f"{course}.yaml").write_text(f"name: {course}\n")
    (path / "config" / "boats" / "swamp.yaml").write_text("name: swamp\n")
    tables = {}
    for name, won in success.items():
        won, n = np.asarray(won, bool), len(won)
        noise = np.random.default_rng([seed, len(name)]).random(first + n)[first:]  # of the episode
        costs = dict.fromkeys(("time", "path_length", "command_change", "energy"), 10.0 + noise)
        if electric:
            costs |= dict.fromkeys(("electric_energy", "energy_per_metre", "range"), 300.0 + noise)
        outcome = np.where(won, "success", "buoy")
        tables[name, "calm"] = {"seed": first + np.arange(n), "success": won, "outcome": outcome, **costs}
    write_episodes(path / "episodes.parquet", tables)
    return path
