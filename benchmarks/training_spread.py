"""How much a pilot's success depends on the seed that it was trained with, and on the runs it learned from.

    python -m benchmarks.training_spread --pilot ppo --seeds 0 1 2 3 4 5 --out spread-ppo.json
    python -m benchmarks.training_spread --pilot cloning --seeds 0 1 2 3 4 5 --out spread-cloning.json

A seed trains the pilot and records its runs. Every pilot drives the same episodes, none of which the main job
evaluates. Writes JSON after each seed; those that are in it already are not trained again.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from experiments.learn import record, train
from experiments.results import mean_command_change
from experiments.scene import Scene, read_scene
from experiments.schema import Experiment, load_experiment
from swamp_rl.evaluation import drive, episode_table, wilson
from swamp_rl.files import write_beside
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.runs import Dataset, read_dataset


def experiment_of(args: argparse.Namespace, seed: int) -> Experiment:
    """The experiment with one seed for training and recording, and the episodes asked for."""
    overrides = [
        f"pilots.{args.pilot}.options.seed={seed}",
        f"data.record.seed={seed}",
        f"evaluation.seed={args.first}",
        f"evaluation.episodes={args.episodes}",
    ]
    return load_experiment(args.experiment, overrides)


def trained(scene: Scene, name: str, folder: Path) -> tuple[Pilot, Dataset, float]:
    """The pilot, the dataset recorded for it, and the processor time of its training [s]."""
    record(scene, folder, lambda done: None)
    dataset = read_dataset(folder)
    began = time.process_time()
    pilot = train(scene, dataset, scene.experiment.pilots[name], lambda done: None)
    return pilot, dataset, time.process_time() - began


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
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(6)))
    parser.add_argument("--episodes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=2_000_000, help="seed of the first episode")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    known = json.loads(args.out.read_text(encoding="utf-8")) if args.out.exists() else {}
    for seed in args.seeds:
        if str(seed) in known:
            continue
        scene = read_scene(experiment_of(args, seed))
        with tempfile.TemporaryDirectory() as folder:
            pilot, dataset, seconds = trained(scene, args.pilot, Path(folder) / "data")
        levels = tried(scene, pilot)
        known[str(seed)] = {
            "first_episode": args.first,
            "episodes": args.episodes,
            "training_cpu_seconds": seconds,
            "data_command_change": mean_command_change(dataset.successful),
            "levels": levels,
        }
        with write_beside(args.out) as part:
            part.write_text(json.dumps(known, indent=2) + "\n", encoding="utf-8")
        print(f"{args.pilot} seed {seed}: {seconds:.0f} s", *_words(levels), sep="  ", flush=True)


def _words(levels: dict[str, Any]) -> list[str]:
    return [f"{level} {found['success']:.3f}" for level, found in levels.items()]


if __name__ == "__main__":
    main()
