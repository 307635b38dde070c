"""Try every pilot in the same episodes at every level."""

from collections.abc import Mapping
from dataclasses import dataclass

from experiments.progress import Stages
from experiments.results import Tables
from experiments.scene import Scene
from swamp_rl.evaluation import drive, episode_table
from swamp_rl.evaluation.rollout import Pilot
from swamp_rl.runs import Run


@dataclass(frozen=True)
class Tried:
    """Episodes by pilot and level, and the runs of the first few of them."""

    tables: Tables
    shown: Mapping[tuple[str, str], list[Run]]


def try_pilots(scene: Scene, pilots: Mapping[str, Pilot], progress: Stages) -> Tried:
    """All episodes of the experiment, each batch of them in one go."""
    tables, shown = {}, {}
    step = scene.experiment.step
    few = min(scene.experiment.evaluation.shown, len(scene.seeds))
    for name, pilot in pilots.items():
        for level, source in scene.levels.items():
            with progress.stage(f"try {name}, {level}", len(scene.seeds)) as tick:
                rollout = drive(pilot, scene.boats_at(source), scene.seeds, tick)
            tables[name, level] = episode_table(rollout, scene.boat, step)
            shown[name, level] = [rollout.run(i, f"{name}-{level}-{i}", step) for i in range(few)]
    return Tried(tables, shown)
