"""Where the time of the main experiment goes, written into docs/experiments.md.

    swamp-rl run camogli
    python -m benchmarks.speed.stages results/camogli

The stages are those that a folder of results tells of. PPO's is divided by a leg of it, here and now, after
another by which all is compiled.
"""

import argparse
import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv
from swamp_rl.experiments.config.learners import learner
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from benchmarks.speed.pilots import Timed
from swamp_rl.pilots.ppo import PPOSettings, train_ppo

FROM_RUNS, PPO_BOATS, PPO_NETWORK = "fit to runs", "PPO: the boats", "PPO: the network"


def divided(seconds: Mapping[str, float], experiment: Experiment, boats_share: float) -> dict[str, float]:
    """Seconds of each kind of work, from those of each stage; boats_share: of the simulation in PPO's."""
    spent: dict[str, float] = {}
    for stage, took in seconds.items():
        verb, _, rest = stage.partition(" ")
        for work, share in _works(verb, rest, experiment, boats_share):
            spent[work] = spent.get(work, 0.0) + share * took
    return spent


def _works(verb: str, rest: str, experiment: Experiment, boats_share: float) -> list[tuple[str, float]]:
    """The kinds of work in a stage, each with its share."""
    if verb == "train":
        kind = experiment.pilots[rest].kind
        if kind == "ppo":
            return [(PPO_BOATS, boats_share), (PPO_NETWORK, 1.0 - boats_share)]
        return [(FROM_RUNS if learner(kind).from_runs else "train others", 1.0)]
    if verb == "evaluate":
        return [(f"evaluate {rest.rsplit(', ', 1)[0]}", 1.0)]
    return [("record runs" if verb == "record" else "compare, draw and write", 1.0)]


def share_of_boats(settings: PPOSettings, disturbances: str | None) -> float:
    """The boats' share of the wall time of one leg of a training by PPO."""
    leg = settings.boats * settings.horizon * settings.leg
    for decisions in (settings.boats * settings.horizon, leg):
        made = GatesVectorEnv(
            settings.boats,
            observation=settings.senses,
            disturbances=disturbances,
            autoreset_mode="SameStep",
        )
        boats: Any = Timed(made, "step_held")
        begin = time.perf_counter()
        train_ppo(GatesVecEnv(boats, settings.hold), settings.model_copy(update={"decisions": decisions}))
        share = boats.seconds / (time.perf_counter() - begin)
    return share


def times(spent: Mapping[str, float]) -> str:
    """Seconds and share of each kind of work."""
    total = sum(spent.values())
    rows = [[work, f"{took:.0f}", f"{100.0 * took / total:.0f}"] for work, took in spent.items()]
    return table(["work", "seconds", "share [%]"], [*rows, ["all", f"{total:.0f}", "100"]])


def machine_table(results: Mapping[str, Any]) -> str:
    """What it was measured on."""
    machine = results["measured"]["hardware"]
    cells = [machine["processor"], str(machine["processors"]), f"{machine['memory_gb']:.0f}"]
    return table(["experiment", "processor", "processors", "memory [GB]"], [[results["name"], *cells]])


def main() -> None:
    """Read a folder of results, try a leg of its PPO, and rewrite the page's table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    folder = parser.parse_args().results
    results, experiment = json.loads((folder / "results.json").read_text()), load_experiment(folder)
    plan = next(plan for plan in experiment.pilots.values() if plan.kind == "ppo")
    share = share_of_boats(PPOSettings.model_validate(plan.options), plan.disturbances)
    spent = divided(results["measured"]["seconds"], experiment, share)
    write_parts(DOCS / "experiments.md", {"time": f"{times(spent)}\n\n{machine_table(results)}"})


if __name__ == "__main__":
    main()
