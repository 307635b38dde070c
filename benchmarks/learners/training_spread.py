"""How much a pilot's success depends on the seed that it was trained with, and on the runs it learned from.

    python -m benchmarks.learners.training_spread --pilot ppo --seeds 0 1 2 3 4 5 --out spread-ppo.json
    python -m benchmarks.learners.training_spread --pilot cloning --seeds 0 1 2 --out spread-cloning.json
    python -m benchmarks.learners.training_spread --experiment severe --pilot ppo-severe --out severe.json

A seed trains the pilot and those that it starts from, and records their runs. Every pilot drives the same
episodes, none of which the main job evaluates. Writes JSON after each seed; those that are in it already are
not trained again, and one that was broken off goes on, where its learner can.
"""

import argparse
import json
import shutil
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.artifacts.results import mean_command_change
from swamp_rl.experiments.config.learners import in_order
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.training.train import record, train

from swamp_rl.evaluation import drive, episode_table, wilson
from swamp_rl.files import write_text
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot, save_pilot
from swamp_rl.runs import Dataset, read_dataset


def experiment_of(args: argparse.Namespace, seed: int) -> Experiment:
    """The experiment with one seed for training and recording, and the episodes asked for."""
    chain = in_order(load_experiment(args.experiment, args.set).pilots, [args.pilot])
    overrides = [
        *args.set,
        *(f"pilots.{name}.options.seed={seed}" for name in chain),
        f"data.record.seed={seed}",
        f"evaluation.seed={args.first}",
        f"evaluation.episodes={args.episodes}",
    ]
    return load_experiment(args.experiment, overrides)


@dataclass
class Trained:
    """A pilot with its runs and its learning curve.

    cpu_seconds: processor time of its training and of those that it starts from, since it last began.
    """

    pilot: Pilot
    dataset: Dataset
    cpu_seconds: float
    curve: list[dict[str, float]]


def trained(scene: Scene, name: str, folder: Path) -> Trained:
    """The pilot, once the runs are recorded and the pilots that it starts from are trained.

    What is whole in `folder` is not done again.
    """
    if not (folder / "data").exists():
        record(scene, folder / "data", lambda done: None)
    dataset = read_dataset(folder / "data")
    plans, pilots, curve = scene.experiment.pilots, dict[str, Pilot](), list[dict[str, float]]()
    began = time.process_time()
    for each in in_order(plans, [name]):
        if each != name and (folder / each).exists():
            pilots[each] = load_pilot(folder / each)
            continue
        curve.clear()  # a pilot that it starts from has a curve of its own
        pilots[each] = train(
            scene,
            dataset,
            plans[each],
            lambda done: None,
            folder / "checkpoint" if each == name else None,
            pilots,
            lambda step, values: curve.append({"step": step, **values}),
        )
        save_pilot(pilots[each], folder / each)
    return Trained(pilots[name], dataset, time.process_time() - began, curve)


def tried(scene: Scene, pilot: Pilot) -> dict[str, Any]:
    """Success with its Wilson interval and mean change of command per step, by level."""
    levels: dict[str, Any] = {}
    for level, source in scene.levels.items():
        rollout = drive(pilot, scene.boats_at(source), scene.seeds)
        succeeded = int((rollout.outcome == "success").sum())
        interval = wilson(succeeded, len(rollout.seeds))
        table = episode_table(rollout, scene.boat, scene.experiment.step)
        change = float(np.mean(table["command_change"]))
        levels[level] = {
            "success": interval.value,
            "wilson_95": [interval.low, interval.high],
            "command_change": change,
        }
    return levels


def main() -> None:
    """One seed after another; each line printed is one seed at one level."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--experiment", default="camogli")
    parser.add_argument("--pilot", required=True, help="one of the experiment's that has a seed")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(10)))
    parser.add_argument("--episodes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=2_000_000, help="seed of the first episode")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="overrides of the file")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    known = json.loads(args.out.read_text(encoding="utf-8")) if args.out.exists() else {}
    for seed in args.seeds:
        if str(seed) in known:
            continue
        known[str(seed)] = found = _of_seed(args, seed)
        write_text(args.out, json.dumps(known, indent=2) + "\n")
        shutil.rmtree(_work(args, seed))
        words = [f"{level} {found['success']:.3f}" for level, found in found["levels"].items()]
        print(
            f"{args.pilot} seed {seed}: {found['training_cpu_seconds']:.0f} s", *words, sep="  ", flush=True
        )


def _of_seed(args: argparse.Namespace, seed: int) -> dict[str, Any]:
    scene = read_scene(experiment_of(args, seed))
    learned = trained(scene, args.pilot, _work(args, seed))
    return {
        "first_episode": args.first,
        "episodes": args.episodes,
        "training_cpu_seconds": learned.cpu_seconds,
        "data_command_change": mean_command_change(learned.dataset.successful),
        "levels": tried(scene, learned.pilot),
        "curve": learned.curve,
    }


def _work(args: argparse.Namespace, seed: int) -> Path:
    """What is kept of a seed until it is done."""
    return args.out.with_name(f"{args.out.stem}-{seed}")


if __name__ == "__main__":
    main()
