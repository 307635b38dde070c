"""What bounds success at `severe`: scripted pilots with fewer and fewer faults, by the strength of the wind.

    python -m benchmarks.learners.severe_limits [--pilot FOLDER]

Drives the episodes from 2000000 on and replaces its section of docs/learners.md.
"""

import argparse
from collections import Counter
from pathlib import Path

import numpy as np
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene

from benchmarks.learners.reinforcement import place
from swamp_rl.evaluation import drive
from swamp_rl.evaluation.rollout import Pilot
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.store import load_pilot

BEGIN, END = "<!-- limits at severe: begin -->", "<!-- limits at severe: end -->"
LEVEL = "severe"
NEVER = 1e6  # s
STEADY = Habits(guess_interval=NEVER, hesitation_interval=NEVER, messy=0.0, gentle=0.0)
PROMPT = STEADY.model_copy(update={"reaction": (0.0, 0.0), "aim_spread": 0.0})
WINDS = ((0.0, 4.0), (4.0, 5.0), (5.0, 6.0), (6.0, 7.0))
OUTCOMES = ("buoy", "out_of_bounds", "timeout")


def winds(scene: Scene) -> np.ndarray:
    """(n,) mean wind speed [m/s] of each episode."""
    boats = scene.boats_at(LEVEL)(len(scene.seeds), ("north",))
    boats.reset(options={"episodes": scene.seeds})
    return boats.fleet.params["wind_speed"].copy()


def section(scene: Scene, pilots: dict[str, Pilot]) -> str:
    """A row for each pilot, and the last for the episodes that any of them won."""
    wind = winds(scene)
    heads = [f"{low:g} to {high:g} m/s" for low, high in WINDS]
    lines = [
        BEGIN,
        "## What bounds success at `severe`",
        "",
        f"Written by `python -m benchmarks.learners.severe_limits`: {len(wind)} episodes from "
        f"{scene.seeds[0]} on; how they were lost, and success by the mean wind.",
        "",
        f"| pilot | success | {' | '.join(OUTCOMES)} | {' | '.join(heads)} |",
        "| --- " * (2 + len(OUTCOMES) + len(WINDS)) + "|",
    ]
    won = np.zeros(len(wind), dtype=bool)
    for name, pilot in pilots.items():
        outcome = drive(pilot, scene.boats_at(LEVEL), scene.seeds).outcome
        won |= outcome == "success"
        lost = Counter(outcome.tolist())
        lines.append(_row(name, outcome == "success", [str(lost[what]) for what in OUTCOMES], wind))
    lines += [_row("any of these", won, ["" for _ in OUTCOMES], wind), END]
    return "\n".join(lines)


def _row(name: str, won: np.ndarray, lost: list[str], wind: np.ndarray) -> str:
    by_wind = [f"{won[(wind >= low) & (wind <= high)].mean():.2f}" for low, high in WINDS]
    return f"| {' | '.join([name, f'{won.mean():.3f}', *lost, *by_wind])} |"


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
    place(section(scene, pilots))


if __name__ == "__main__":
    main()
