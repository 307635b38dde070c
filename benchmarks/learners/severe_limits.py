"""What bounds success at `severe`: scripted pilots with fewer and fewer faults, by the strength of the wind.

    python -m benchmarks.learners.severe_limits [--pilot FOLDER]

Drives the episodes from 2000000 on and replaces its table in docs/learners.md.
"""

import argparse
from collections import Counter
from pathlib import Path

import numpy as np
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.evaluation import drive
from swamp_rl.evaluation.rollout import Pilot
from swamp_rl.pilots.dagger import STEADY
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import load_pilot

LEVEL = "severe"
PROMPT = STEADY.model_copy(update={"reaction": (0.0, 0.0), "aim_spread": 0.0})
WINDS = ((0.0, 4.0), (4.0, 5.0), (5.0, 6.0), (6.0, 7.0))
OUTCOMES = ("buoy", "out_of_bounds", "timeout")


def winds(scene: Scene) -> np.ndarray:
    """(n,) mean wind speed [m/s] of each episode."""
    boats = scene.boats_at(LEVEL)(len(scene.seeds), ("north",))
    boats.reset(options={"episodes": scene.seeds})
    return boats.fleet.params["wind_speed"].copy()


def limits_table(scene: Scene, pilots: dict[str, Pilot]) -> str:
    """A row for each pilot, and the last for the episodes that any of them won."""
    wind = winds(scene)
    heads = ["pilot", "success", *OUTCOMES, *(f"{low:g} to {high:g} m/s" for low, high in WINDS)]
    rows, won = [], np.zeros(len(wind), dtype=bool)
    for name, pilot in pilots.items():
        outcome = drive(pilot, scene.boats_at(LEVEL), scene.seeds).outcome
        won |= outcome == "success"
        lost = Counter(outcome.tolist())
        rows.append(_row(name, outcome == "success", [str(lost[what]) for what in OUTCOMES], wind))
    return table(heads, [*rows, _row("any of these", won, ["" for _ in OUTCOMES], wind)])


def _row(name: str, won: np.ndarray, lost: list[str], wind: np.ndarray) -> list[str]:
    by_wind = [f"{won[(wind >= low) & (wind <= high)].mean():.2f}" for low, high in WINDS]
    return [name, f"{won.mean():.3f}", *lost, *by_wind]


def main() -> None:
    """The scripted pilot as it is, without slips, and acting at once; with --pilot, one that learned."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pilot", type=Path, help="a stored pilot's folder")
    args = parser.parse_args()
    scene = read_scene(load_experiment("camogli", ["evaluation.seed=2000000", "evaluation.episodes=1000"]))
    pilots: dict[str, Pilot] = {
        "scripted": ScriptedPilot(1),
        "scripted, no slips": ScriptedPilot(1, STEADY),
        "scripted, no slips, acting at once": ScriptedPilot(1, PROMPT),
    }
    if args.pilot is not None:
        pilots["learned"] = load_pilot(args.pilot)
    write_parts(DOCS / "learners.md", {"limits at severe": limits_table(scene, pilots)})


if __name__ == "__main__":
    main()
