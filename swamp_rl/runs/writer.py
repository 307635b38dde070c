"""Writing runs: each one whole on the disk and listed, or not there at all."""

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Literal

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.files import flush, os_error, write_beside, write_text, yaml_text
from swamp_rl.names import file_in
from swamp_rl.runs.check import check_load, check_table
from swamp_rl.runs.copies import boat_of, standing_alone
from swamp_rl.runs.dataset import read_meta
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import ANALYSIS, META, DatasetMeta, RunMeta
from swamp_rl.runs.table import FORMATS, Table, read_table, write_table
from swamp_rl.sums import SUMS
from swamp_rl.unfinished import folder_beside, locked

PATIENCE = 10.0
"""s that a writer waits for another one, which holds the lock while it writes."""


def create_dataset(
    folder: Path | str, meta: DatasetMeta, boat: str | Path | None = None, course: str | Path | None = None
) -> None:
    """Make a folder for runs yet to be appended, with copies of its boat's and its course's files.

    meta: of the new dataset; runs that it lists, as of a dataset that is copied, are left out. boat, course:
    names or paths of these, by default those that `meta` gives, a file in the folder first.
    UserError if the folder already holds a dataset, other runs or other files of the copies' names; the same
    files are of a process that was killed before it wrote `dataset.yaml`.
    """
    folder = Path(folder)
    boat, course = boat or _there(folder, meta.vehicle), course or _there(folder, meta.course)
    meta, copies = standing_alone(meta.model_copy(update={"runs": []}), boat, course)
    own = {Path(given).name for given in (boat, course) if given is not None and Path(given).parent == folder}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = sorted(path.name for path in folder.iterdir())
        held = [name for name in names if name == META or Path(name).suffix[1:] in FORMATS]
        foreign = [name for name in names if name in copies.keys() - own]
        held += [name for name in foreign if not _holds(folder / name, copies[name])]
    except OSError as error:
        raise os_error(error, folder) from error
    if held:
        raise UserError(f"{folder}: already holds {held[0]}; name another folder for the new dataset")
    for name, copy in copies.items():
        with write_beside(folder / name) as part:
            part.write_bytes(copy)
    _write_meta(folder, _as_yaml(folder, meta))


def _holds(path: Path, copy: bytes) -> bool:
    same = not path.is_symlink() and path.is_file() and path.stat().st_size == len(copy)
    return same and path.read_bytes() == copy


def _there(folder: Path, name: str | None) -> str | Path | None:
    beside = folder / (name or "")
    return beside if name is not None and beside.is_file() else name


@contextmanager
def dataset_beside(folder: Path | str, meta: DatasetMeta, new: bool = False) -> Iterator[Path]:
    """Yield a new dataset beside `folder`, which takes its place once the block has ended well.

    new: replace nothing, not even an earlier dataset of the same kind.

    UserError where the folder holds anything but an earlier dataset of the same source and notes: what one
    writer makes never takes the place of what a person drove or another writer made.
    """
    folder = Path(folder)
    if not new and (folder / META).exists():
        there = read_meta(folder)
        if (there.source, there.notes) != (meta.source, meta.notes):
            raise UserError(f"{folder}: holds other runs, {there.source} ones; name another folder")
    with folder_beside(folder, replaces=None if new else META, derived=(ANALYSIS,)) as part:
        create_dataset(part, meta)
        yield part


def append_run(folder: Path | str, run: Run, format: Literal["parquet", "csv"] = "parquet") -> Path:
    """Add a run to a dataset and return its file, safe on the disk when this returns.

    The table is written beside and renamed, then `dataset.yaml` likewise: a writer stopped between the two
    leaves the dataset as it was and a file that `check_dataset` reports as not listed. Of several writers one
    waits for the other. A run with a fault is refused with UserError.
    """
    return append_runs(folder, [run], format)[0]


def append_runs(
    folder: Path | str, runs: Sequence[Run], format: Literal["parquet", "csv"] = "parquet"
) -> list[Path]:
    """As `append_run` for many, with `dataset.yaml` read and written once: its cost grows with its length."""
    folder = Path(folder)
    paths = [file_in(folder, f"{run.name}.{format}", (f".{format}",)) for run in runs]
    with _alone(folder):
        extended = _as_yaml(folder, _listing(folder, paths, runs))
        for path, run in zip(paths, runs, strict=True):
            write_table(path, run.columns)
        _write_meta(folder, extended)
    return paths


def adopt_run(folder: Path | str, table: Path, run: RunMeta) -> Path:
    """Take the finished CSV `table`, written elsewhere on the same disk, into a dataset; return its new path.

    It keeps its name and its bytes: it is checked, renamed into the folder, and listed. UserError as
    `append_run`; what is refused stays where it was.
    """
    path = file_in(Path(folder), table.name, (".csv",))
    read = read_table(table)
    if read.faults:
        raise UserError(f"{table.parent}{os.sep}{read.faults[0]}")
    with _alone(path.parent):
        extended = _as_yaml(path.parent, _listing(path.parent, [path], [Run(table.stem, read.columns, run)]))
        os.replace(table, path)
        flush(path.parent)
        _write_meta(path.parent, extended)
    return path


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold the lock of a dataset's `dataset.yaml`; UserError where another writer holds it for PATIENCE."""
    until = time.monotonic() + PATIENCE
    with ExitStack() as held:
        while True:
            try:
                held.enter_context(locked(folder / META))
                break
            except UserError:
                if time.monotonic() > until or not os.access(folder, os.W_OK):
                    raise
                time.sleep(0.01)
        yield


def _listing(folder: Path, paths: Sequence[Path], runs: Sequence[Run]) -> DatasetMeta:
    """The folder's `dataset.yaml` with the runs added; UserError for a name taken or a run at fault."""
    meta = read_meta(folder)
    boat, entries = boat_of(folder, meta), list(meta.runs)
    for fault in check_load(meta, boat):
        raise UserError(f"{folder}{os.sep}{fault}")
    taken = {found.name for found in folder.iterdir()} | {str(listed.file) for listed in meta.runs}
    for path, run in zip(paths, runs, strict=True):
        if any(f"{run.name}.{kind}" in taken for kind in FORMATS):
            raise UserError(f"{folder / run.name}: this run already exists; name the new one otherwise")
        given = {**run.meta.model_dump(), "file": path.name, "rows": len(run.time)}
        entries.append(RunMeta.model_validate(given))
        taken.add(path.name)
        _refuse_faults(path, run, boat, meta.sample_rate)
    return DatasetMeta.model_validate({**meta.model_dump(), "runs": entries})


def write_run(path: Path | str, run: Run) -> None:
    """Write one run's table to a .csv or .parquet file; a run with a fault is refused with UserError."""
    path = Path(path)
    _refuse_faults(path, run, None, None)
    write_table(path, run.columns)


def _as_yaml(folder: Path, meta: DatasetMeta) -> str:
    """The text of `dataset.yaml`; UserError where it would be too long to be read."""
    # runs, even where there are none yet: left out, they would be whatever tables lie there
    entries = meta.model_dump(exclude_defaults=True)
    try:
        return yaml_text(entries | {"runs": entries.get("runs", [])})
    except UserError as error:
        raise UserError(f"{folder / META}: {error}; put further runs into another folder") from error


def _write_meta(folder: Path, text: str) -> None:
    # From now on the folder is no longer as it was exported.
    (folder / SUMS).unlink(missing_ok=True)
    write_text(folder / META, text)


def _refuse_faults(path: Path, run: Run, boat: Boat | None, sample_rate: float | None) -> None:
    lengths = {name: len(values) for name, values in run.columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns of a run have one length, not {lengths}")
    rows = np.arange(1, next(iter(lengths.values()), 0) + 1)
    faults = check_table(path.name, Table(run.columns, rows), boat, sample_rate)
    if faults:
        raise UserError(f"{path.parent}{os.sep}{faults[0]}; the run was not written")
