"""Whether logged runs hold what a pilot meets in its evaluation: where it starts, and disturbances."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.counted import counted
from swamp_rl.files import find_config, read_yaml
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.demonstrations import is_demonstration
from swamp_rl.runs import Run


def starts_outside(scene: Scene, runs: Sequence[Run]) -> float:
    """Share of the evaluation's starts that lie more than a boat's length from every row of `runs` that
    teaches."""
    rows = np.concatenate([run.pose[is_demonstration(run)] for run in runs])
    starts = np.concatenate([_starts(scene, level) for level in scene.levels.values()])
    distance, _ = cKDTree(rows[:, :2]).query(starts[:, :2])
    return float(np.mean(distance > scene.boat.length))


def warning(scene: Scene, name: str, runs: Sequence[Run]) -> str | None:
    """One line where the pilot of that name is to start outside of what it learns from; else None."""
    outside = starts_outside(scene, runs)
    if outside == 0.0:
        return None
    message = "no run covers the starts of the evaluation" if outside == 1.0 else "not every start is covered"
    return (
        f"pilots.{name}: {message}: {100.0 * outside:.0f} % of the evaluation's starts are more than "
        f"{scene.boat.length:g} m from the {len(runs)} training runs; record runs from the start of "
        f"{scene.course.name} on"
    )


def calm_warning(scene: Scene, name: str, runs: Sequence[Run]) -> str | None:
    """One line where most of the runs that the pilot of that name learns from met no disturbance, and it is
    to be evaluated at levels with some; else None. Runs that do not tell theirs do not count as calm."""
    rough = [level_name for level_name, level in scene.levels.items() if _disturbs(level)]
    calm = sum(run.meta.disturbances in ([], "calm") for run in runs)
    if not rough or 2 * calm <= len(runs):
        return None
    level = scene.levels[rough[0]]
    ours = scene.experiment.data.folder is None  # recorded by the experiment
    advice = f"set data.record.disturbances={level}" if ours else f"record runs with --disturbances {level}"
    return (
        f"pilots.{name}: recorded without disturbances: {calm} of {counted(len(runs), 'training run')}; "
        f"evaluated at {', '.join(rough)}; if it fails there, {advice}"
    )


def _disturbs(level: str) -> bool:
    return bool(read_yaml(find_config("disturbances", level)).get("effects"))


def _starts(scene: Scene, level: str) -> Array:
    """(n, 3) poses as sensed at the start of the evaluation's episodes."""
    boats = scene.boats_at(level)(len(scene.seeds), ("north",))
    try:
        boats.reset(options={"episodes": scene.seeds})
        return boats.sensed_pose.copy()
    finally:
        boats.close()
