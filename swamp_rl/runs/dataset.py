"""A dataset: a folder of runs, and the `dataset.yaml` that describes them or what is worked out for it."""

import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from swamp_rl.boat import Boat, load_boat
from swamp_rl.clipped import printable
from swamp_rl.counted import and_others
from swamp_rl.course import Course, fitted, load_course
from swamp_rl.errors import UserError
from swamp_rl.files import is_file, refuse_object
from swamp_rl.names import YAML, file_in
from swamp_rl.runs.check import MISSING, check_load, check_table, unknown_columns
from swamp_rl.runs.copies import boat_file, boat_of, course_file
from swamp_rl.runs.describe import (
    common_rate,
    datasets_within,
    described,
    is_table,
    noted,
    parse,
    with_outcomes,
)
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.local_frame import GEODETIC, origin_of
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import META as META
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.runs.table import FORMATS, Table, read_table
from swamp_rl.sums import SUMS, changed

NO_FOLDER = "is a file, not a folder of runs; swamp-rl runs import makes one of a log"
SUFFIXES = tuple(f".{kind}" for kind in FORMATS)


@dataclass(frozen=True)
class Dataset:
    """A folder of runs, read whole and without a fault.

    named_boat, named_course: as whoever reads it named them, where the folder does not.
    """

    folder: Path
    meta: DatasetMeta
    runs: list[Run]
    named_boat: str | Path | None = None
    named_course: str | Path | None = None

    @property
    def successful(self) -> list[Run]:
        """The runs a learner is to use: those that ended in success."""
        return [run for run in self.runs if run.meta.outcome == "success"]

    @property
    def boat_file(self) -> str | Path:
        """Where its boat is read from, for `load_boat`; UserError as `boat_of`."""
        return self.named_boat or boat_file(self.folder, self.meta)

    @cached_property
    def boat(self) -> Boat:
        """Its boat, read once; UserError as `boat_of`."""
        return load_boat(self.named_boat) if self.named_boat else boat_of(self.folder, self.meta)

    @property
    def course_file(self) -> str | Path | None:
        """Where its course is read from, None where it has none; UserError as `course_of`."""
        return self.named_course or course_file(self.folder, self.meta)

    @property
    def course(self) -> Course | None:
        """Its course, None where it has none; UserError as `course_of`."""
        found = self.course_file
        return None if found is None else fitted(load_course(found), self.boat.length)


def as_on_disk(given: "Dataset | Path | str") -> Path:
    """The folder of a dataset, read or named; UserError where one that was read has other runs by now."""
    if not isinstance(given, Dataset):
        return Path(given)
    if [run.name for run in given.runs] != [Path(str(meta.file)).stem for meta in given.meta.runs]:
        raise UserError(
            f"{given.folder}: its runs are read again from the folder, and this dataset has others; write "
            "these into a folder of their own"
        )
    return given.folder


@dataclass
class Inspection:
    """All there is to say about a folder: `notes` are no faults (unknown columns, leftovers of a writer)."""

    meta: DatasetMeta | None = None
    runs: list[Run] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    named_boat: str | Path | None = None
    named_course: str | Path | None = None


def read_dataset(
    folder: Path | str, boat: str | Path | None = None, course: str | Path | None = None
) -> Dataset:
    """Read a dataset, or a plain folder of tables; UserError with the first fault.

    `boat`, `course`: name or file, for a folder without dataset.yaml. In such a folder, and for each key that
    dataset.yaml leaves out: the runs are all .csv and .parquet files, their outcome is evaluated on the
    course, mass, draught and water density are the boat's, and the sample rate is that of the times.
    """
    for kind, given in (("boats", boat), ("courses", course)):
        if given is not None:
            refuse_object(kind, given)
    found = inspect_dataset(folder, boat, course)
    refuse_faults(Path(folder), found.faults)
    assert found.meta is not None
    return Dataset(Path(folder), found.meta, found.runs, found.named_boat, found.named_course)


def refuse_faults(folder: Path, faults: Sequence[Fault]) -> None:
    """UserError with the first fault of a dataset and what lists the others, if there is one."""
    if not faults:
        return
    quoted = shlex.quote(str(folder))
    lacking = {fault.column for fault in faults if fault.message.startswith(MISSING)}
    if not (folder / META).exists() and len(lacking) > 1:
        hint = f" (a log of another program: swamp-rl runs import {quoted} --list)"
    else:
        hint = f" (and {len(faults) - 1} more: swamp-rl runs check {quoted})" if len(faults) > 1 else ""
    raise UserError(f"{folder}{os.sep}{faults[0]}{hint}")


def check_dataset(folder: Path | str) -> list[Fault]:
    """Every fault of a dataset by file, row and column; empty if there is none."""
    return inspect_dataset(folder).faults


def inspect_dataset(
    folder: Path | str, boat: str | Path | None = None, course: str | Path | None = None
) -> Inspection:
    """Read what can be read of a dataset and list every fault; UserError only if there is no such folder.

    boat, course: as for `read_dataset`.
    """
    refuse_object("datasets", folder)
    folder = Path(folder)
    if is_file(folder):
        raise UserError(f"{folder}: {NO_FOLDER}")
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; name one that holds a {META}")
    description, faults = parse(folder, boat, course)
    found = Inspection(faults=faults + [Fault(SUMS, None, None, line) for line in changed(folder)])
    if description is None:
        return found
    found.named_boat, found.named_course = description.named_boat, description.named_course
    vessel = None
    try:
        vessel = (
            load_boat(description.named_boat) if description.named_boat else boat_of(folder, description.meta)
        )
    except UserError as error:
        found.faults.append(Fault(META, None, None, str(error).removeprefix(f"{folder / META}: ")))
    meta = found.meta = described(description, vessel)
    if vessel is not None:
        found.faults += check_load(meta, vessel)
    if not meta.runs:
        found.faults.append(Fault(META, None, None, "runs: lists no runs; record some first"))
    rate = None if "sample_rate" in description.lacking else meta.sample_rate
    for run in meta.runs:
        _inspect_run(folder, run, vessel, rate, found)
    found.notes += _unknown(found.runs, vessel)
    if "sample_rate" in description.lacking and not found.faults:
        rate, found.faults = common_rate(found.runs)
        found.meta = meta.model_copy(update={"sample_rate": rate})
    if "runs" in description.lacking and not found.faults and vessel is not None:
        found.runs = with_outcomes(
            found.runs, _course(folder, description.named_course, meta, vessel), vessel
        )
        found.meta = found.meta.model_copy(update={"runs": [run.meta for run in found.runs]})
    found.notes += noted(description, found.meta)
    _look_for_unlisted_files(folder, found)
    return found


def _course(folder: Path, named: str | Path | None, meta: DatasetMeta, vessel: Boat) -> Course | None:
    source = named or course_file(folder, meta)
    return None if source is None else fitted(load_course(source), vessel.length)


def read_meta(folder: Path) -> DatasetMeta:
    """What the folder's `dataset.yaml` says, and what it leaves out as for `read_dataset`; UserError at its
    first fault."""
    description, faults = parse(folder)
    if description is not None and not description.lacking:
        return description.meta
    return read_dataset(folder).meta if description is not None else _refused(folder, faults)


def own_boat(folder: Path) -> str | Path:
    """Where the boat that a dataset names is read from, whatever its runs hold; UserError as `read_meta`."""
    return boat_file(folder, read_meta(folder))


def files_of(folder: Path) -> list[Path]:
    """All files that a dataset is made of: description, copies, runs; UserError where one is not there."""
    if is_file(folder):
        raise UserError(f"{folder}: {NO_FOLDER}")
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; name one of runs")
    if not (folder / META).exists():
        found = sorted(path.name for path in folder.iterdir() if is_table(path))
        if not found:
            advice = datasets_within(folder) or "name a folder of .csv or .parquet files"
            raise UserError(f"{folder}: no runs here; {advice}")
        return [file_in(folder, name, SUFFIXES) for name in found]
    meta = read_meta(folder)
    runs = [file_in(folder, str(run.file), SUFFIXES) for run in meta.runs]
    paths = [folder / META, *(file_in(folder, name, YAML) for name in meta.copies), *runs]
    for path in paths:
        if not path.is_file():
            raise UserError(f"{path}: no such file, but {META} lists it; put it there or drop it")
    return paths


def _refused(folder: Path, faults: list[Fault]) -> DatasetMeta:
    raise UserError(f"{folder}{os.sep}{faults[0]}")


def _inspect_run(
    folder: Path, meta: RunMeta, boat: Boat | None, rate: float | None, found: Inspection
) -> None:
    assert meta.file is not None
    try:
        path = file_in(folder, meta.file, SUFFIXES)
    except UserError as error:
        found.faults.append(Fault(meta.file, None, None, str(error).partition(": ")[2]))
        return
    if not path.is_file():
        message = f"is listed in {META} but is not here; restore it or remove its entry"
        found.faults.append(Fault(meta.file, None, None, message))
        return
    table = read_table(path)
    found.faults += check_table(meta.file, table, boat, rate)
    if meta.rows is not None and table.whole and len(table.rows) != meta.rows:
        message = f"holds {len(table.rows)} rows, {META} has {meta.rows}; restore the file or correct rows"
        found.faults.append(Fault(meta.file, None, None, message))
    found.runs.append(Run(path.stem, table.columns, meta))


def _unknown(runs: Sequence[Run], boat: Boat | None) -> list[str]:
    """Columns that the format does not know, but for positions that a run's origin is of: a line for all of
    the same files."""
    files: dict[str, list[str]] = {}
    for run in runs:
        known = GEODETIC if origin_of(run.meta.model_extra or {}) else ()
        for name in unknown_columns([one for one in run.columns if one not in known], boat):
            files.setdefault(name, []).append(str(run.meta.file))
    of_files: dict[tuple[str, ...], list[str]] = {}
    for name, every in files.items():
        of_files.setdefault(tuple(every), []).append(name)
    return [
        f"{and_others(every)}: column {names[0]} is not in the run format; kept as it is"
        if len(names) == 1
        else f"{and_others(every)}: columns {', '.join(names)} are not in the run format; kept as they are"
        for every, names in of_files.items()
    ]


def _look_for_unlisted_files(folder: Path, found: Inspection) -> None:
    assert found.meta is not None
    listed = {run.file for run in found.meta.runs}
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".part-"):
            name = printable(path.name)
            found.notes.append(f"{name}: left by a writer that was stopped; it may be deleted")
        elif is_table(path) and path.name not in listed:
            message = f"is not listed in {META} (was a writer stopped?); add it to runs, or delete it"
            found.faults.append(Fault(path.name, None, None, message))


def read_run(path: Path | str, lost_rows: bool = False) -> Run:
    """One run's table, with what a `dataset.yaml` beside it says of it; UserError at the first fault.

    lost_rows: whether faults of its times may pass, for a reader that puts the rows on a grid of its own.
    """
    path = Path(path)
    if path.is_dir():
        raise UserError(f"{path}: is a folder; name the .csv or .parquet file of one run in it")
    if not path.is_file():
        raise UserError(f"{path}: no such file; name a run's .csv or .parquet file")
    meta, boat, rate = RunMeta(), None, None
    if (path.parent / META).exists():
        dataset = read_meta(path.parent)
        boat, rate = boat_of(path.parent, dataset), dataset.sample_rate
        meta = next((run for run in dataset.runs if run.file == path.name), meta)
    table: Table = read_table(path)
    faults = check_table(path.name, table, boat, rate)
    if lost_rows:
        faults = [fault for fault in faults if fault.column != "time"]
    if faults:
        raise UserError(f"{path.parent}{os.sep}{faults[0]}")
    return Run(path.stem, table.columns, meta)
