"""The pilots' own runs, kept beside the results so that they can be shown, exported and learned from."""

from pathlib import Path

from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.evaluation.episodes import Tried
from swamp_rl.experiments.evaluation.race import Race

from swamp_rl.pilots.record import replayable
from swamp_rl.runs import Dataset, Run, RunMeta, create_dataset
from swamp_rl.runs.schema import meta_of
from swamp_rl.runs.writer import append_runs

NOTES = "Driven in evaluation by the pilot of that name; each run tells its level and its disturbances."


def write_shown(dataset: Dataset, race: Race, folder: Path) -> None:
    """The run of the data in the race as a dataset of its own, for results whose data lie elsewhere."""
    empty = dataset.meta.model_copy(update={"copies": {}})
    create_dataset(folder, empty, dataset.boat_file, dataset.course_file)
    append_runs(folder, [race[dataset.meta.source]])


def write_driven(scene: Scene, tried: Tried, race: Race, folder: Path) -> None:
    """The runs of `tried.shown` and of the race as one dataset for each pilot, `folder`/PILOT."""
    drawn = {level: _drawn(scene, level) for level in scene.levels}
    for pilot, plan in scene.experiment.pilots.items():
        meta = meta_of(
            scene.boat,
            scene.experiment.boat,
            1.0 / scene.experiment.step,
            "scripted" if plan.kind in ("scripted", "line-of-sight") else "learned",
            course=scene.experiment.course,
            notes=NOTES,
        )
        create_dataset(folder / pilot, meta)
        runs = []
        for level in scene.levels:
            for run, disturbed in zip(tried.shown[pilot, level], drawn[level], strict=False):
                metadata = run.meta.model_dump() | disturbed | {"pilot": pilot, "level": level}
                runs.append(Run(run.name, run.columns, RunMeta.model_validate(metadata)))
        append_runs(folder / pilot, runs + [run for who, run in race.items() if who == pilot])


def _drawn(scene: Scene, level: str) -> list[dict[str, object]]:
    """How the episodes that are shown began and what disturbed them, the same for every pilot."""
    seeds = scene.seeds[: scene.experiment.evaluation.shown]
    boats = scene.boats_at(scene.levels[level])(len(seeds), ("north",))
    try:
        boats.reset(options={"episodes": seeds})
        return [replayable(boats, i) for i in range(len(seeds))]
    finally:
        boats.close()
