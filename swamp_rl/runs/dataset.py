"""A dataset: a folder of runs and the `dataset.yaml` that describes them."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import ValidationError

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.files import explanations, os_error, read_yaml, write_yaml
from swamp_rl.runs.check import check_table, unknown_columns
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.runs.table import FORMATS, Table, read_table, write_table

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
    found.meta, found.faults = _read_meta(folder)
    if found.meta is None:
        return found
    boat = None
    try:
        boat = _known_boat(folder, found.meta)
    except UserError as error:
        found.faults.append(Fault(META, None, None, str(error).removeprefix(f"{folder / META}: ")))
    if not found.meta.runs:
        found.faults.append(Fault(META, None, "runs", "lists no runs; record some first"))
    for meta in found.meta.runs:
        _inspect_run(folder, meta, boat, found)
    _look_for_unlisted_files(folder, found)
    return found


def _read_meta(folder: Path) -> tuple[DatasetMeta | None, list[Fault]]:
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


def _whole_meta(folder: Path) -> DatasetMeta:
    meta, faults = _read_meta(folder)
    if meta is None:
        raise UserError(f"{folder}{os.sep}{faults[0]}")
    return meta


def _known_boat(folder: Path, meta: DatasetMeta) -> Boat:
    """The dataset's boat: a file beside the runs, or one known by name or path."""
    beside = folder / meta.vehicle
    try:
        return load_boat(beside if beside.is_file() else meta.vehicle)
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
        message = (
            f"holds {len(table.rows)} rows, {META} says {meta.rows}; restore the whole file or correct `rows`"
        )
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
            message = f"is not listed in {META} (a writer stopped half-way leaves this); add it to runs, or delete it"
            found.faults.append(Fault(path.name, None, None, message))


def create_dataset(folder: Path | str, meta: DatasetMeta) -> None:
    """Make a folder for runs yet to be appended; UserError if it already holds a dataset or other runs."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        held = sorted(
            path.name for path in folder.iterdir() if path.name == META or path.suffix[1:] in FORMATS
        )
    except OSError as error:
        raise os_error(error, folder) from error
    if held:
        raise UserError(f"{folder}: already holds {held[0]}; name another folder for the new dataset")
    _write_meta(folder, meta)


def append_run(folder: Path | str, run: Run, format: Literal["parquet", "csv"] = "parquet") -> Path:
    """Add a run to a dataset and return its file, safe on the disk when this returns.

    The table is written beside and renamed, then `dataset.yaml` likewise: a writer stopped between the two leaves
    the dataset as it was and a file that `check_dataset` reports as not listed. A run with a fault is refused.
    """
    folder = Path(folder)
    meta = _whole_meta(folder)
    path = folder / f"{run.name}.{format}"
    taken = [folder / f"{run.name}.{kind}" for kind in FORMATS if (folder / f"{run.name}.{kind}").exists()]
    if taken or any(Path(str(listed.file)).stem == run.name for listed in meta.runs):
        raise UserError(
            f"{taken[0] if taken else path}: already exists; name the run otherwise, or delete the old one"
        )
    entry = RunMeta.model_validate({**run.meta.model_dump(), "file": path.name, "rows": len(run.time)})
    extended = DatasetMeta.model_validate({**meta.model_dump(), "runs": [*meta.runs, entry]})
    _refuse_faults(path, run, _known_boat(folder, meta), meta.sample_rate)
    write_table(path, run.columns)
    _write_meta(folder, extended)
    return path


def _write_meta(folder: Path, meta: DatasetMeta) -> None:
    write_yaml(folder / META, meta.model_dump(exclude_defaults=True))


def _refuse_faults(path: Path, run: Run, boat: Boat | None, sample_rate: float | None) -> None:
    lengths = {name: len(values) for name, values in run.columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns of a run have one length, not {lengths}")
    rows = np.arange(1, next(iter(lengths.values()), 0) + 1)
    faults = check_table(path.name, Table(run.columns, rows), boat, sample_rate)
    if faults:
        raise UserError(f"{path.parent}{os.sep}{faults[0]}; the run was not written")


def read_run(path: Path | str) -> Run:
    """One run's table, with what a `dataset.yaml` beside it says of it; UserError at the first fault."""
    path = Path(path)
    if not path.is_file():
        raise UserError(f"{path}: no such file; name a run's .csv or .parquet file")
    meta, boat, rate = RunMeta(), None, None
    if (path.parent / META).exists():
        dataset = _whole_meta(path.parent)
        boat, rate = _known_boat(path.parent, dataset), dataset.sample_rate
        meta = next((run for run in dataset.runs if run.file == path.name), meta)
    table = read_table(path)
    faults = check_table(path.name, table, boat, rate)
    if faults:
        raise UserError(f"{path.parent}{os.sep}{faults[0]}")
    return Run(path.stem, table.columns, meta)


def write_run(path: Path | str, run: Run) -> None:
    """Write one run's table to a .csv or .parquet file; a run with a fault is refused with UserError."""
    path = Path(path)
    _refuse_faults(path, run, None, None)
    write_table(path, run.columns)
