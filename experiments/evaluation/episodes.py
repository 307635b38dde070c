"""Try every pilot in the same episodes at every level."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from swamp_rl.experiments.artifacts.results import Tables
from swamp_rl.experiments.artifacts.stages import Stages
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.arrays_file import AGAIN, read_arrays, write_arrays
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.evaluation import Table, drive, episode_table
from swamp_rl.evaluation.episodes import checked_table
from swamp_rl.evaluation.rollout import Pilot
from swamp_rl.runs import Run, RunMeta
from swamp_rl.runs.columns import missing_columns


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
                tables[name, level], shown[name, level] = _read(file, scene, _shown(scene, name, level))
    return Tried(tables, shown)


def _try(scene: Scene, name: str, pilot: Pilot, level: str, progress: Stages) -> tuple[Table, list[Run]]:
    step = scene.experiment.step
    with progress.stage(f"evaluate {name}, {level}", len(scene.seeds)) as tick:
        rollout = drive(pilot, scene.boats_at(scene.levels[level]), scene.seeds, tick)
        table = episode_table(rollout, scene.boat, step)
    return table, [rollout.run(i, run, step) for i, run in enumerate(_shown(scene, name, level))]


def _shown(scene: Scene, name: str, level: str) -> list[str]:
    """Names of the runs that are kept."""
    few = min(scene.experiment.evaluation.shown, len(scene.seeds))
    return [f"{name}-{level}-{i}" for i in range(few)]


def _write(file: Path, table: Table, shown: list[Run]) -> None:
    """The table, and each run's columns, under names that `_read` takes apart again."""
    arrays = {f"table/{column}": values for column, values in table.items()}
    for run in shown:
        arrays |= {f"{run.name}/{column}": values for column, values in run.columns.items()}
    write_arrays(file, arrays)


def _read(file: Path, scene: Scene, names: Sequence[str]) -> tuple[Table, list[Run]]:
    """What `_write` wrote of the scene's episodes and the runs `names`; UserError for anything else."""
    parts: dict[str, Table] = {}
    for key, values in read_arrays(file).items():
        name, _, column = key.partition("/")
        parts.setdefault(name, {})[column] = values
    table = checked_table(file, parts.pop("table", {}))
    if not np.array_equal(table["seed"], scene.seeds) or list(parts) != list(names):
        raise UserError(f"{file}: holds other episodes than those of the experiment; {AGAIN}")
    if not all(_is_run(columns, scene.boat) for columns in parts.values()):
        raise UserError(f"{file}: holds something else than runs; {AGAIN}")
    outcomes = zip(table["seed"].tolist(), table["outcome"].tolist(), strict=True)
    metas = [RunMeta(seed=seed, outcome=outcome) for seed, outcome in outcomes]
    return table, [
        Run(name, columns, meta) for (name, columns), meta in zip(parts.items(), metas, strict=False)
    ]


def _is_run(columns: Table, boat: Boat) -> bool:
    """Whether all columns of a run are there, as numbers of one length above 0."""
    if missing_columns(list(columns), boat):
        return False
    rows = columns["time"].shape
    whole = len(rows) == 1 and rows != (0,)
    return whole and all(one.shape == rows and one.dtype == np.float64 for one in columns.values())
