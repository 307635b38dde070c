"""Make what `swamp-rl demo` shows without an argument: small trained pilots, and a run to show them beside.

    python -m benchmarks.learners.shipped_pilots

trains and evaluates `configs/experiments/shipped.yaml`, puts its pilots into `configs/pilots` and a run of
the scripted pilot into `configs/runs`. To be called again when the boat or the observation changes; it takes
about a minute.
"""

import math
import shutil
import tempfile
from itertools import count
from pathlib import Path

import numpy as np
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.studies.run import run_experiment

from swamp_rl.boat import load_boat
from swamp_rl.pilots.record import NOTES, drive_episodes
from swamp_rl.pilots.scripted import ScriptedPilot, habits_of
from swamp_rl.pilots.store import DESCRIPTION, WEIGHTS
from swamp_rl.runs import Run, append_run
from swamp_rl.runs.schema import meta_of
from swamp_rl.runs.writer import dataset_beside
from swamp_rl.sums import write_sums
from swamp_rl.unfinished import folder_beside

CONFIGS = Path(__file__).parents[2] / "configs"
BOAT, COURSE, LEVEL, STEP = "swamp", "camogli", "standard", 0.1
WIND, CURRENT = 2.5, 0.15
"The least mean wind and current [m/s] of the episode shown: enough to be seen."


def make_pilots(folder: Path) -> list[str]:
    """Train and evaluate in `folder`, and put the pilots where the package has them; their names."""
    results = run_experiment("shipped", out=folder)
    names = sorted(path.name for path in (results / "pilots").iterdir())
    for name in names:
        with folder_beside(CONFIGS / "pilots" / name, replaces=DESCRIPTION) as part:
            for file in (DESCRIPTION, WEIGHTS):
                shutil.copyfile(results / "pilots" / name / file, part / file)
    return names


def shown_seed() -> int:
    """The first seed whose episode has that much wind and current, whoever drives and however it ends."""
    boats = GatesVectorEnv(1, boat=BOAT, course=COURSE, disturbances=LEVEL, observation=("north",), step=STEP)
    for seed in count():
        boats.reset(seed=seed)
        drawn = {entry["effect"]: entry for entry in boats.fleet.drawn(0)["effects"]}
        current = math.hypot(drawn["current"]["north"], drawn["current"]["east"])
        if drawn["wind"]["speed"] >= WIND and current >= CURRENT:
            break
    boats.close()
    return seed


def make_run() -> Run:
    """The scripted pilot's run, as a dataset that stands alone."""
    boat = load_boat(BOAT)
    seed = shown_seed()
    pilot = ScriptedPilot(0, habits_of("usual", boat.length), STEP)
    pilot.reset(1)
    boats = GatesVectorEnv(
        1, boat=boat, course=COURSE, disturbances=LEVEL, observation=pilot.senses, step=STEP
    )
    (driven,) = drive_episodes(boats, pilot, boat, np.array([seed]), STEP)
    boats.close()
    run = Run(f"{LEVEL}-{seed}", driven.columns, driven.meta)
    meta = meta_of(boat, BOAT, 1.0 / STEP, "scripted", course=COURSE, notes=NOTES)
    with dataset_beside(CONFIGS / "runs" / COURSE, meta) as part:
        append_run(part, run)
        write_sums(part)
    return run


def main() -> None:
    """Both, and say what came of it."""
    with tempfile.TemporaryDirectory() as folder:
        for name in make_pilots(Path(folder) / "shipped"):
            print(f"{CONFIGS / 'pilots' / name}")
    run = make_run()
    print(f"{CONFIGS / 'runs' / COURSE}: {run.name}, {run.meta.outcome}, {run.duration:.1f} s")


if __name__ == "__main__":
    main()
