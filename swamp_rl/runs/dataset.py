"""A dataset: a folder of runs and the `dataset.yaml` that describes them."""

import os
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import ValidationError

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.files import explanations, is_file, read_yaml
from swamp_rl.runs.check import check_table, unknown_columns
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.runs.table import FORMATS, read_table
from swamp_rl.sums import SUMS, changed

META = "dataset.yaml"


@dataclass(frozen=True)
class Dataset:
    """A folder of runs, read whole and without a fault."""

    folder: Path
    meta: DatasetMeta
    runs: list[Run]

    @property
    def successful(self) -> list[Run]:
        """The runs a learner is to use: those that ended in success."""
        return [run for run in self.runs if run.meta.outcome == "success"]


@dataclass
class Inspection:
    """All there is to say about a folder: `notes` are no faults (unknown columns, leftovers of a writer)."""

    meta: DatasetMeta | None = None
    runs: list[Run] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read_dataset(folder: Path | str) -> Dataset:
    """Read a dataset; the first of its faults is raised as UserError."""
    folder = Path(folder)
    found = inspect_dataset(folder)
    if found.faults or found.meta is None:
        more = len(found.faults) - 1
        others = f" (and {more} more: swamp-rl runs check {folder})" if more else ""
        raise UserError(f"{folder}{os.sep}{found.faults[0]}{others}")
    return Dataset(folder, found.meta, found.runs)


def check_dataset(folder: Path | str) -> list[Fault]:
    """Every fault of a dataset by file, row and column; empty if there is none."""
    return inspect_dataset(folder).faults


def inspect_dataset(folder: Path | str) -> Inspection:
    """Read what can be read of a dataset and list every fault; UserError only if there is no such folder."""
    folder = Path(folder)
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; name one that holds a {META}")
    found = Inspection()
    found.meta, found.faults = _parse_meta(folder)
    found.faults += [Fault(SUMS, None, None, line) for line in changed(folder)]
    if found.meta is None:
        return found
    boat = None
    try:
        boat = boat_of(folder, found.meta)
    except UserError as error:
        found.faults.append(Fault(META, None, None, str(error).removeprefix(f"{folder / META}: ")))
    if not found.meta.runs:
        found.faults.append(Fault(META, None, "runs", "lists no runs; record some first"))
    for meta in found.meta.runs:
        _inspect_run(folder, meta, boat, found)
    _look_for_unlisted_files(folder, found)
    return found


def _parse_meta(folder: Path) -> tuple[DatasetMeta | None, list[Fault]]:
    path = folder / META
    if not path.exists():
        return None, [Fault(META, None, None, "is missing; every folder of runs needs one")]
    try:
        return DatasetMeta.model_validate(read_yaml(path)), []
    except UserError as error:
        return None, [Fault(META, None, None, str(error).removeprefix(f"{path}: "))]
    except ValidationError as error:
        faults = explanations(error, DatasetMeta)
        return None, [
            Fault(META, None, None, f"{key}: {message}" if key else message) for key, message in faults
        ]


def read_meta(folder: Path) -> DatasetMeta:
    """The folder's `dataset.yaml` alone; UserError at its first fault."""
    meta, faults = _parse_meta(folder)
    if meta is None:
        raise UserError(f"{folder}{os.sep}{faults[0]}")
    return meta


def boat_of(folder: Path, meta: DatasetMeta) -> Boat:
    """The dataset's boat: a file beside the runs, or one known by name or path."""
    beside = folder / meta.vehicle
    try:
        return load_boat(beside if is_file(beside) else meta.vehicle)
    except UserError as error:
        raise UserError(f"{folder / META}: vehicle: {error}") from error


def _inspect_run(folder: Path, meta: RunMeta, boat: Boat | None, found: Inspection) -> None:
    assert meta.file is not None and found.meta is not None
    path = folder / meta.file
    if not path.is_file():
        message = f"is listed in {META} but is not here; restore it or remove its entry"
        found.faults.append(Fault(meta.file, None, None, message))
        return
    table = read_table(path)
    found.faults += check_table(meta.file, table, boat, found.meta.sample_rate)
    if meta.rows is not None and table.whole and len(table.rows) != meta.rows:
        message = f"holds {len(table.rows)} rows, {META} says {meta.rows}; restore the file or correct rows"
        found.faults.append(Fault(meta.file, None, None, message))
    found.notes += [
        f"{meta.file}: column {name} is not in the run format; kept as it is"
        for name in unknown_columns(list(table.columns), boat)
    ]
    found.runs.append(Run(path.stem, table.columns, meta))


def _look_for_unlisted_files(folder: Path, found: Inspection) -> None:
    assert found.meta is not None
    listed = {run.file for run in found.meta.runs}
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".part-"):
            found.notes.append(f"{path.name}: left by a writer that was stopped; it may be deleted")
        elif path.suffix.lower().lstrip(".") in FORMATS and path.name not in listed:
            message = f"is not listed in {META} (was a writer stopped?); add it to runs, or delete it"
            found.faults.append(Fault(path.name, None, None, message))


def read_run(path: Path | str, lost_rows: bool = False) -> Run:
    """One run's table, with what a `dataset.yaml` beside it says of it; UserError at the first fault.

    lost_rows: whether faults of its times may pass, for a reader that puts the rows on a grid of its own.
    """
    path = Path(path)
    if not path.is_file():
        raise UserError(f"{path}: no such file; name a run's .csv or .parquet file")
    meta, boat, rate = RunMeta(), None, None
    if (path.parent / META).exists():
        dataset = read_meta(path.parent)
        boat, rate = boat_of(path.parent, dataset), dataset.sample_rate
        meta = next((run for run in dataset.runs if run.file == path.name), meta)
    table = read_table(path)
    faults = check_table(path.name, table, boat, rate)
    if lost_rows:
        faults = [fault for fault in faults if fault.column != "time"]
    if faults:
        raise UserError(f"{path.parent}{os.sep}{faults[0]}")
    return Run(path.stem, table.columns, meta)
