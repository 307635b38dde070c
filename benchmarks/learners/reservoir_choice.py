"""Does the lever error on runs left out tell how well a reservoir drives, and how long does learning take?

    python -m benchmarks.learners.reservoir_choice --out choice.json

Every setting of a grid is scored by cross-validation over the runs of each dataset, learned from all of them
and driven in the same episodes, none of which the main job evaluates. Kept after each; a second call goes on.
"""

import argparse
import json
import tempfile
import time
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.envs.hindsight import with_gates
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.training.train import record

from swamp_rl.evaluation import drive
from swamp_rl.files import write_text
from swamp_rl.pilots.demonstrations import choose_runs
from swamp_rl.pilots.reservoir import ReservoirSettings, fit_reservoir
from swamp_rl.pilots.reservoir_search import errors_left_out
from swamp_rl.runs import Run, read_dataset

UNITS, RADII, RIDGES, FOLDS = (100, 200, 400), (0.2, 0.9), (0.3, 3.0, 30.0), 5
TIMED = ReservoirSettings(units=500)


def scene_of(seed: int, args: argparse.Namespace) -> Scene:
    """The main job's, recorded with another seed and tried in the episodes asked for."""
    asked = (
        f"data.record.seed={seed}",
        f"evaluation.seed={args.first}",
        f"evaluation.episodes={args.episodes}",
    )
    return read_scene(load_experiment("camogli", asked))


def runs_of(scene: Scene) -> list[Run]:
    """All successful runs of the scripted pilot."""
    with tempfile.TemporaryDirectory() as folder:
        record(scene, Path(folder) / "data", lambda good: None)
        chosen = choose_runs(read_dataset(Path(folder) / "data").runs)
    return [with_gates(run, scene.course) for run in chosen]


def tried(runs: list[Run], scene: Scene, settings: ReservoirSettings) -> dict[str, float]:
    """Error left out and success at `standard` of one setting."""
    error = errors_left_out(runs, settings, (settings.ridge,), FOLDS)[0]
    outcome = drive(fit_reservoir(runs, settings), scene.boats_at("standard"), scene.seeds).outcome
    return {"error": float(error), "success": float((outcome == "success").mean())}


def correlation(entries: dict[str, Any]) -> dict[str, float]:
    """Per dataset, Spearman's rank correlation of error and success, and the success of the least error."""
    from scipy.stats import spearmanr

    found = {}
    for seed in sorted({key.split()[0] for key in entries}):
        of_seed = [entry for key, entry in entries.items() if key.split()[0] == seed]
        errors, success = ([entry[name] for entry in of_seed] for name in ("error", "success"))
        found |= {
            f"{seed}: rank correlation": float(spearmanr(errors, success).statistic),
            f"{seed}: success of the least error": success[int(np.argmin(errors))],
            f"{seed}: greatest success": max(success),
        }
    return found


def main() -> None:
    """The grid for each dataset, then the time of one fit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1])
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--first", type=int, default=1_000_000, help="seed of the first episode")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    known = json.loads(args.out.read_text(encoding="utf-8")) if args.out.exists() else {"grid": {}}
    for seed in args.seeds:
        scene = scene_of(seed, args)
        runs = runs_of(scene)
        if "fit_500_units_40_runs_s" not in known:
            known["fit_500_units_40_runs_s"] = timed(runs)
        for units, radius, ridge in product(UNITS, RADII, RIDGES):
            key = f"{seed} {units} units, radius {radius:g}, ridge {ridge:g}"
            if key not in known["grid"]:
                settings = ReservoirSettings(units=units, spectral_radius=radius, ridge=ridge, seed=seed)
                known["grid"][key] = tried(runs[:20], scene, settings)
                print(key, known["grid"][key], flush=True)
                write_text(args.out, json.dumps(known, indent=2) + "\n")
    print(f"{known['fit_500_units_40_runs_s']:.2f} s for 500 units on 40 runs")
    print(json.dumps(correlation(known["grid"]), indent=2))


def timed(runs: list[Run]) -> float:
    """Wall time [s] of a fit, the second of two: the first imports."""
    fit_reservoir(runs[:2], TIMED)
    began = time.perf_counter()
    fit_reservoir(runs, TIMED)
    return time.perf_counter() - began


if __name__ == "__main__":
    main()
