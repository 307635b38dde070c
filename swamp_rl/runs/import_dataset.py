"""From files of others to one dataset of ours, whole or not at all."""

import os
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args

from swamp_rl.boat import Boat, load_boat
from swamp_rl.counted import and_others
from swamp_rl.course import fitted, load_course
from swamp_rl.errors import UserError
from swamp_rl.names import file_in, told_apart
from swamp_rl.runs.bad_rows import REFUSED, listed
from swamp_rl.runs.columns import is_angle
from swamp_rl.runs.copies import boat_file, course_file, write_copies
from swamp_rl.runs.dataset import SUFFIXES as OF_RUNS
from swamp_rl.runs.dataset import read_meta
from swamp_rl.runs.describe import rate_of, with_outcome, with_outcomes
from swamp_rl.runs.earlier_commands import with_earlier_commands
from swamp_rl.runs.faults import NUMBER
from swamp_rl.runs.free_running import import_free_running, is_free_running
from swamp_rl.runs.import_foreign import Foreign, Wishes, runs_from
from swamp_rl.runs.import_telemetry import read_telemetry
from swamp_rl.runs.kind_of_file import SUFFIXES
from swamp_rl.runs.local_frame import Place, origin_of
from swamp_rl.runs.mcap_files import read_mcap
from swamp_rl.runs.missing_marks import without_marks
from swamp_rl.runs.resample import resampled_run
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import META, DatasetMeta, Source, entries_of
from swamp_rl.runs.table import FORMATS, read_table
from swamp_rl.runs.text_header import TEXTS
from swamp_rl.runs.writer import append_runs, create_dataset
from swamp_rl.sums import refuse_changed_files
from swamp_rl.unfinished import folder_beside

Outcome = Literal["success", "failed", "auto"]
Kind = Literal["csv", "parquet", "mcap", "telemetry", "free-running"]


@dataclass(frozen=True)
class About:
    """What the files do not tell: `boat` (a name or file), who drove, the course, how the runs ended (`auto`:
    worked out from the course), their `group` (day, place), and for some kinds the `topic` (mcap), the
    `sender` (telemetry), whether to end a run before its first hole (free-running).
    None: as the source's own dataset has it, else the swamp, measured, on no course; outcomes are worked out
    where a course is named."""

    boat: str | None = None
    source: Source | None = None
    course: str | None = None
    notes: str | None = None
    outcome: Outcome | None = None
    group: str | None = None
    topic: str | None = None
    sender: int | None = None
    repair: bool = False


OTHER_UNIT = "looks like"
"""Words of a fault that all files of a recorder have."""
ROWS = re.compile(r" \(in (each|\d+) of rows [^)]*\)")
"""Rows for which a fault holds, which differ between files."""
ALONE = {"topic": "mcap", "sender": "telemetry", "repair": "free-running"}
"""Kinds that alone have what an entry of `About` chooses."""
OF_COLUMNS = {
    "renamed": "--column",
    "units": "--unit or --degrees",
    "dropped": "--drop",
    "rate": "--rate",
    "resample": "--resample",
    "origin": "--origin",
    "bad_rows": "--bad-rows",
    "fill": "--fill",
}
"""Options by entries of `Wishes`, but for free-running tests, whose columns and units are always the same."""


def refuse_idle(kind: str, about: About, wishes: Wishes) -> None:
    """UserError for options that cannot act on files of a kind."""
    idle = [f"--{name}" for name, own in ALONE.items() if own != kind and _is_given(name, about, About())]
    if kind == "free-running":
        idle += [option for name, option in OF_COLUMNS.items() if _is_given(name, wishes, Wishes())]
    if idle:
        raise UserError(f"{', '.join(idle)}: not for --from {kind}, where it cannot act; leave it out")


def _is_given(name: str, options: About | Wishes, plain: About | Wishes) -> bool:
    return bool(getattr(options, name) != getattr(plain, name))


def import_runs(
    sources: Sequence[Path],
    kind: Kind,
    out: Path | str,
    about: About | None = None,
    wishes: Wishes | None = None,
) -> DatasetMeta:
    """Write the runs of `sources` (files, or folders of them) into the new dataset `out`; what it then says.

    UserError with file, row and column at the first fault, and then there is no `out`.
    """
    about, wishes = about or About(), wishes or Wishes()
    if kind not in get_args(Kind):
        raise UserError(f"--from {kind}: is none of {', '.join(get_args(Kind))}")
    refuse_idle(kind, about, wishes)
    names = names_apart(sources, lambda source: files_of_kind([source], kind))
    if kind == "free-running":
        pond = about.boat or "esso_osaka"
        boat = load_boat(pond)
        read = [(name, import_free_running(file, boat, about.repair)) for file, name in names.items()]
        runs = [Run(name, run.columns, run.meta) for name, run in read]
        runs = _ended(_earlier(runs, wishes), about, about.course, boat, True)
        return _write(Path(out), _described(about, boat, None, runs, wishes), runs, pond, about.course)
    found, wishes = _read(list(names), kind, about, wishes)
    named = [replace(one, name=name) for name, one in zip(names.values(), found, strict=True)]
    return import_tables(named, out, about, wishes)


def import_tables(found: Sequence[Foreign], out: Path | str, about: About, wishes: Wishes) -> DatasetMeta:
    """Write the runs in foreign tables into the new dataset `out`; what it then says.

    UserError lists the faults of all tables, and then there is no `out`.
    """
    if wishes.fill and wishes.resample is None and not any(one.even for one in found):
        raise UserError(
            "--fill: fills gaps of joined tables and of --resample HZ; give that, or leave it out"
        )
    metadata, found = _agreed(found), _of_days(found)
    with tempfile.TemporaryDirectory() as scratch:
        home = found[0].home or Path(scratch)
        write_copies(home, found[0].copies)
        source: str | Path = about.boat or (boat_file(home, metadata) if metadata else "swamp")
        course = about.course or (course_file(home, metadata) if metadata else None)
        boat = load_boat(source)
        runs = _earlier(_all_runs(found, wishes, boat), wishes)
        runs = _ended(runs, about, course, boat, metadata is None)
        if wishes.resample is not None and not any(one.even for one in found):
            runs = [resampled_run(run, wishes.resample) for run in runs]
        return _write(Path(out), _described(about, boat, metadata, runs, wishes), runs, source, course)


def _all_runs(found: Sequence[Foreign], wishes: Wishes, boat: Boat) -> list[Run]:
    """The runs of all tables, in one frame where they are near each other; UserError with the faults of all
    that have any."""
    runs: list[Run] = []
    origins: list[Place] = []
    refused: dict[str, list[str]] = {}  # what is wrong, and the files of which it is said
    alike: dict[str, str] = {}  # the first fault of those that differ by numbers only
    for one in found:
        try:
            runs += runs_from(one, wishes, boat, origins)
            origin = origin_of(runs[-1].meta.model_extra or {})
            origins += [origin] if origin is not None and origin not in origins else []
        except UserError as error:
            for line in dict.fromkeys(str(error).removesuffix(f"; {REFUSED}").splitlines()):
                own = line.removeprefix(f"{one.file}: ")
                said = alike.setdefault(NUMBER.sub("#", ROWS.sub("", own)), own) if OTHER_UNIT in own else own
                refused.setdefault(said, []).extend([one.file] * (own != line))
    if refused:
        lines = [f"{and_others(files)}: {one}" if files else one for one, files in refused.items()]
        raise UserError(listed(lines, REFUSED))
    return runs


def _earlier(runs: list[Run], wishes: Wishes) -> list[Run]:
    return [with_earlier_commands(run, wishes.earlier) for run in runs] if wishes.earlier else runs


def _ended(runs: list[Run], about: About, course: str | Path | None, boat: Boat, foreign: bool) -> list[Run]:
    """The runs with their outcomes and their group, as asked or as the course tells."""
    if about.group is not None:
        runs = [_with(run, group=about.group) for run in runs]
    if about.outcome in ("success", "failed"):
        return [_with(run, outcome=about.outcome) for run in runs]
    if about.outcome == "auto" and course is None:
        raise UserError("--outcome auto: is worked out from a course; name it (--course NAME)")
    found = None if course is None else fitted(load_course(course), boat.length)
    if about.outcome == "auto" and found is not None:
        return [with_outcome(run, found, boat) for run in runs]
    return with_outcomes(runs, found, boat) if foreign else runs


def _with(run: Run, **message: str) -> Run:
    return Run(run.name, run.columns, run.meta.model_copy(update=message))


def files_of_kind(sources: Sequence[Path], kind: str) -> list[Path]:
    """The files of a kind (a key of SUFFIXES) that sources are or hold."""
    return [file for source in sources for file in _files(source, kind)]


def whole_folder(folder: Path, kind: str) -> list[Path]:
    """All files of a kind in a folder and the folders in it; UserError where there is none."""
    files = [file_in(file.parent, file.name, SUFFIXES[kind]) for file in _in_folders(folder, kind)]
    if not files:
        raise UserError(f"{folder}: neither it nor a folder in it has {' or '.join(SUFFIXES[kind])} files")
    return files


def _files(source: Path, kind: str) -> list[Path]:
    """A file itself; of a folder, the runs its `dataset.yaml` lists, those of CSV and Parquet together, else
    all files of the kind by name, its own or, where it has none, those of the folders in it."""
    if source.is_file():
        return [source]
    if not source.is_dir():
        raise UserError(f"{source}: no such file or folder; check the name")
    refuse_changed_files(source)
    if (source / META).is_file():
        named = [source / str(run.file) for run in read_meta(source).runs]
        if not named:
            raise UserError(f"{source}: is a dataset without runs; leave it out")
        if kind in FORMATS:
            return sorted(file_in(file.parent, file.name, OF_RUNS) for file in named)
    else:
        named = _of_kind(source.iterdir(), kind) or _in_folders(source, kind)
    files, suffixes = _of_kind(named, kind), " or ".join(SUFFIXES[kind])
    if not files:
        raise UserError(f"{source}: neither it nor a folder in it has {suffixes} runs; check --from {kind}")
    if len(files) < len(named):
        raise UserError(f"{source}: its runs are not all {suffixes}; check --from {kind}")
    return [file_in(file.parent, file.name, SUFFIXES[kind]) for file in files]


def _of_kind(paths: Iterable[Path], kind: str) -> list[Path]:
    kept = (path for path in paths if not path.name.startswith("."))
    return sorted(path for path in kept if path.suffix.lower() in SUFFIXES[kind])


def _in_folders(source: Path, kind: str) -> list[Path]:
    """Without the tables of figures that stand beside free-running tests."""
    found = _of_kind((path for path in source.rglob("*") if path.is_file()), kind)
    return [path for path in found if kind != "free-running" or is_free_running(path)]


def names_apart(sources: Sequence[Path], files_of: Callable[[Path], Sequence[Path]]) -> dict[Path, str]:
    """The files, or folders, that sources hold or are, and the names of their runs: with what tells the
    sources' folders apart before it where several have one of the same name. UserError where one has."""
    found = [(source, file) for source in sources for file in files_of(source)]
    own = [file.name if file.is_dir() else file.stem for _, file in found]
    count = Counter(map(str.casefold, own))  # some file systems take both for one
    homes = {
        file: (source if source.is_dir() and source != file else file.parent).resolve()
        for name, (source, file) in zip(own, found, strict=True)
        if count[name.casefold()] > 1
    }
    parts = told_apart(set(homes.values()))
    names: dict[Path, str] = {}
    by_name: dict[str, Path] = {}
    for name, (_, file) in zip(own, found, strict=True):
        names[file] = "-".join((*parts[homes[file]], name)) if file in homes else name
        if other := by_name.get(names[file].casefold()):
            raise UserError(
                f"{file}: would be a run of the same name as {other}; rename one, or name their folders, or "
                "give --join-folders if the files of a folder are tables of one run"
            )
        by_name[names[file].casefold()] = file
    return names


def _read(files: Sequence[Path], kind: Kind, about: About, wishes: Wishes) -> tuple[list[Foreign], Wishes]:
    """The tables, and what is then still to be done to them."""
    if kind == "mcap":
        return [read_mcap(file, about.topic) for file in files], wishes
    if kind == "telemetry":
        # The velocities hang on the yaw, so its unit matters before there is a table.
        units = {name: unit for name, unit in wishes.units.items() if (name, unit) != ("heading", "deg")}
        degrees = len(units) < len(wishes.units)
        boat = load_boat(about.boat or "swamp")
        found = [read_telemetry(file, about.sender, degrees, boat) for file in files]
        return found, replace(wishes, units=units)
    folders = {file.parent for file in files}
    metas = {folder: read_meta(folder) for folder in folders if (folder / META).is_file()}
    return [_read_table(file, kind, metas.get(file.parent), wishes) for file in files], wishes


def _of_days(found: Sequence[Foreign]) -> list[Foreign]:
    """The runs; those of several datasets, which are diagnosed as days, with the name of their dataset as
    their group where they have none, and before a group that several have."""
    homes = {one.file: one.home.resolve() for one in found if one.dataset is not None and one.home}
    parts = told_apart(set(homes.values()))
    having = Counter(group for group, _ in {(one.meta.group, homes.get(one.file)) for one in found})

    def of_day(one: Foreign) -> Foreign:
        home, group = homes.get(one.file), one.meta.group
        if home is None or len(parts) < 2 or (group and having[group] == 1):
            return one
        dataset = "-".join(parts[home])
        name = f"{dataset} {group}" if group else dataset
        return replace(one, meta=one.meta.model_copy(update={"group": name}))

    return [of_day(one) for one in found]


def _agreed(found: Sequence[Foreign]) -> DatasetMeta | None:
    """What all the files say of their dataset, with the notes of all; UserError where they are of different
    ones."""
    described = [(one.file, one.dataset) for one in found if one.dataset is not None]
    if not described:
        return None
    first, agreed = described[0]
    ours, notes = agreed.model_dump(exclude={"runs", "notes"}), ""
    for file, dataset in described:
        theirs = dataset.model_dump(exclude={"runs", "notes"})
        if other := [key for key in {**ours, **theirs} if theirs.get(key) != ours.get(key)]:
            raise UserError(
                f"{file}: is of another dataset than {first}, with another {other[0]}; import it separately"
            )
        if dataset.notes and dataset.notes not in notes:
            notes = f"{notes} {dataset.notes}".lstrip()
    return agreed.model_copy(update={"runs": [], "notes": notes or None})


def _read_table(path: Path, kind: Kind, dataset: DatasetMeta | None, wishes: Wishes) -> Foreign:
    if dataset is None and path.suffix.lower() not in (TEXTS if kind == "csv" else SUFFIXES[kind]):
        raise UserError(f"{path}: is no {SUFFIXES[kind][0]} file; check --from {kind}")
    table = read_table(path)
    if dataset is None:
        ours = {theirs: our for our, theirs in wishes.renamed.items()}
        angles = [name for name in table.columns if is_angle(ours.get(name, name))]
        return Foreign(str(path), path.stem, without_marks(path.name, table, angles))
    meta = entries_of(dataset, path.name)
    return Foreign(str(path), path.stem, table, meta, dataset, home=path.parent)


def _described(
    about: About, boat: Boat, metadata: DatasetMeta | None, runs: Sequence[Run], wishes: Wishes
) -> DatasetMeta:
    """`dataset.yaml` of the new dataset; entries of the source's own stay, except those given."""
    rate = wishes.resample or rate_of(runs)
    if metadata is not None and abs(metadata.sample_rate / rate - 1.0) < 1e-6:
        rate = metadata.sample_rate
    particulars = metadata if metadata is not None and about.boat is None else boat
    return DatasetMeta(
        vehicle=boat.name,
        mass=particulars.mass,
        draught=particulars.draught,
        water_density=particulars.water_density,
        sample_rate=rate,
        source=about.source or (metadata.source if metadata else "measured"),
        notes=about.notes or (metadata.notes if metadata else None),
        licence=metadata.licence if metadata else None,
    )


def _write(
    out: Path, meta: DatasetMeta, runs: Sequence[Run], boat: str | Path, course: str | Path | None
) -> DatasetMeta:
    """boat, course: where their files are read from."""
    if out.exists():
        raise UserError(f"{out}: already exists; runs are imported into a new folder, name another")
    with folder_beside(out) as part:
        try:
            create_dataset(part, meta, boat, course)
            append_runs(part, runs)
        except UserError as error:
            # The folder that is being built is nobody's business.
            raise UserError(str(error).replace(f"{part}{os.sep}", "")) from error
    return read_meta(out)
