"""Try every pilot in the same episodes at every level."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from swamp_rl.experiments.artifacts.results import Tables
from swamp_rl.experiments.artifacts.stages import Stages
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.arrays_file import read_arrays, write_arrays
from swamp_rl.evaluation import Table, drive, episode_table
from swamp_rl.evaluation.rollout import Pilot
from swamp_rl.runs import Run, RunMeta


@dataclass(frozen=True)
class Tried:
    """Episodes by pilot and level, and the runs of the first few of them."""

    tables: Tables
    shown: Mapping[tuple[str, str], list[Run]]


def try_pilots(
    scene: Scene, pilots: Mapping[str, Pilot], progress: Stages, keep: Path | None = None
) -> Tried:
    """All episodes of the experiment, each batch of them in one go.

    keep: the folder that each batch's outcome is kept in, and read from where it is there already.
    """
    tables, shown = {}, {}
    for name, pilot in pilots.items():
        for level in scene.levels:
            file = None if keep is None else keep / name / f"{level}.npz"
            if file is None or not file.is_file():
                tables[name, level], shown[name, level] = _try(scene, name, pilot, level, progress)
                if file is not None:
                    _write(file, tables[name, level], shown[name, level])
            else:
                tables[name, level], shown[name, level] = _read(file)
    return Tried(tables, shown)


def _try(scene: Scene, name: str, pilot: Pilot, level: str, progress: Stages) -> tuple[Table, list[Run]]:
    step = scene.experiment.step
    few = min(scene.experiment.evaluation.shown, len(scene.seeds))
    with progress.stage(f"evaluate {name}, {level}", len(scene.seeds)) as tick:
        rollout = drive(pilot, scene.boats_at(scene.levels[level]), scene.seeds, tick)
        table = episode_table(rollout, scene.boat, step)
    return table, [rollout.run(i, f"{name}-{level}-{i}", step) for i in range(few)]


def _write(file: Path, table: Table, shown: list[Run]) -> None:
    """The table, and each run's columns, under names that `_read` takes apart again."""
    arrays = {f"table/{column}": values for column, values in table.items()}
    for run in shown:
        arrays |= {f"{run.name}/{column}": values for column, values in run.columns.items()}
    write_arrays(file, arrays)


def _read(file: Path) -> tuple[Table, list[Run]]:
    parts: dict[str, Table] = {}
    for key, values in read_arrays(file).items():
        name, column = key.split("/")
        parts.setdefault(name, {})[column] = values
    table = parts.pop("table")
    outcomes = zip(table["seed"].tolist(), table["outcome"].tolist(), strict=True)
    metas = [RunMeta(seed=seed, outcome=outcome) for seed, outcome in outcomes]
    return table, [
        Run(name, columns, meta) for (name, columns), meta in zip(parts.items(), metas, strict=False)
    ]
