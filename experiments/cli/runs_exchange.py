"""`swamp-rl runs import` and `runs export`: datasets from and for other programs."""

from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import typer
from swamp_rl.experiments.cli.place import place_of
from swamp_rl.experiments.cli.runs import BoatOption, Folder, boat_for, runs_app

from swamp_rl.clipped import clipped
from swamp_rl.counted import and_others, counted
from swamp_rl.errors import LONGEST, UserError

if TYPE_CHECKING:
    from swamp_rl.runs.schema import DatasetMeta

NOTED = (
    "times",
    "part",
    "kept",
    "joined",
    "velocity",
    "clocks",
    "resampled",
    "azimuths",
    "commands",
    "commands_shifted",
    "unknown_columns",
    "not_imported",
    "not_read",
)
"""Entries of a run's metadata that are printed."""

Sources = Annotated[list[Path], typer.Argument(help="Files, or folders of them.")]
From = Annotated[
    Literal["csv", "parquet", "mcap", "telemetry", "free-running", "matlab", "dataflash", "ulog", "rosbag"]
    | None,
    typer.Option("--from", help="Format; by default by the suffix."),
]
Out = Annotated[Path | None, typer.Option(help="The new dataset.")]
BoatOfRuns = Annotated[str | None, typer.Option(help="Boat of the runs; by default swamp.")]
Source = Annotated[
    Literal["measured", "simulated", "human", "scripted", "learned"] | None,
    typer.Option(help="Origin of the runs; by default measured."),
]
Course = Annotated[str | None, typer.Option(help="A name in configs/courses, or a file.")]
Notes = Annotated[str | None, typer.Option(help="Remarks for dataset.yaml.")]
Outcome = Annotated[
    Literal["success", "failed", "auto"] | None,
    typer.Option(help="Outcome of the runs; auto (default with --course): by the course."),
]
Group = Annotated[str | None, typer.Option(help="Day or place of runs that share their weather.")]
Column = Annotated[list[str] | None, typer.Option(metavar="OUR=THEIRS", help="Column name in the source.")]
Degrees = Annotated[
    list[str] | None, typer.Option(metavar="OUR", help="A column that is in degrees in the source.")
]
UnitOf = Annotated[
    list[str] | None,
    typer.Option(
        metavar="OUR=UNIT",
        help="Unit of a column in the source: deg, deg/s, kn, km/h, km, cm, ms, rpm, percent …",
    ),
]
Drop = Annotated[list[str] | None, typer.Option(metavar="THEIRS", help="A column to leave out.")]
Rate = Annotated[
    float | None, typer.Option(min=1e-3, max=1e6, help="Sample rate (Hz), in place of the source's times.")
]
Resample = Annotated[float | None, typer.Option(min=1e-3, max=1e6, help="Resample to this rate (Hz).")]
Origin = Annotated[
    str | None,
    typer.Option(
        metavar="LATITUDE,LONGITUDE",
        help="Origin of north and east; by default the first log's first position.",
    ),
]
Topic = Annotated[str | None, typer.Option(help="Topic of an MCAP file with several.")]
Sender = Annotated[int | None, typer.Option(help="Sender, in telemetry of several hulls.")]
Repair = Annotated[bool, typer.Option("--repair", help="Truncate a free-running test at its first gap.")]
Map = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        metavar="OUR=EXPRESSION",
        help="A column as an expression of source columns, or a .yaml file of such.",
    ),
]
FrameOf = Annotated[
    Literal["ned", "enu"] | None,
    typer.Option(help="Frame of x, y, yaw, vx, vy, u, v, r of --map; by default ned, of ROS enu."),
]
Clock = Annotated[
    list[str] | None,
    typer.Option(metavar="A~B", help="The same quantity in two tables, to align the second's clock."),
]
Join = Annotated[
    str | None, typer.Option(metavar="NAME", help="Join the files as tables of one run of this name.")
]
JoinFolders = Annotated[
    bool,
    typer.Option("--join-folders", help="Each source is a folder whose files are tables of one run."),
]
BadRows = Annotated[
    Literal["refuse", "cut", "split"],
    typer.Option(
        help="Invalid rows: refuse the file, keep the longest valid stretch, or keep all valid stretches."
    ),
]
List = Annotated[bool, typer.Option("--list", help="Only print tables, rates, fields and suggested options.")]
Earlier = Annotated[
    float,
    typer.Option(
        "--commands-earlier",
        min=-60.0,
        max=60.0,
        metavar="SECONDS",
        help="Take the commands this much earlier, of a log that stamps them after the motion they cause.",
    ),
]
Fill = Annotated[float, typer.Option(min=0.0, max=60.0, help="Longest gap (s) that --resample interpolates.")]


@runs_app.command("import")
def import_(
    sources: Sources,
    from_: From = None,
    out: Out = None,
    boat: BoatOfRuns = None,
    source: Source = None,
    course: Course = None,
    notes: Notes = None,
    outcome: Outcome = None,
    group: Group = None,
    column: Column = None,
    degrees: Degrees = None,
    unit: UnitOf = None,
    drop: Drop = None,
    rate: Rate = None,
    resample: Resample = None,
    origin: Origin = None,
    topic: Topic = None,
    sender: Sender = None,
    repair: Repair = False,
    map_: Map = None,
    frame: FrameOf = None,
    clock: Clock = None,
    join: Join = None,
    join_folders: JoinFolders = False,
    bad_rows: BadRows = "refuse",
    list_: List = False,
    fill: Fill = 0.0,
    commands_earlier: Earlier = 0.0,
) -> None:
    """Convert logs to a dataset: tables, messages, telemetry, free-running tests."""
    from swamp_rl.logs.import_logs import MAPPED, Reading, import_logs
    from swamp_rl.logs.mapping import mapping_of
    from swamp_rl.runs.import_dataset import About, Kind, import_runs
    from swamp_rl.runs.import_foreign import Wishes
    from swamp_rl.runs.kind_of_file import kind_of

    renamed, units, dropped = _pairs("--column", column), _units(degrees, unit), tuple(drop or ())
    wishes = Wishes(
        renamed, units, dropped, rate, resample, place_of(origin), bad_rows, fill, commands_earlier
    )
    about = About(boat, source, course, notes, outcome, group, topic, sender, repair)
    kind = from_ or kind_of(sources)
    if list_:
        _list(sources, kind, join_folders, join, boat)
        return
    if out is None:
        raise UserError("--out: the new dataset has no name; give one, or --list")
    if kind in MAPPED or map_ or frame or clock or join or join_folders:
        if renamed or dropped:
            raise UserError("--column, --drop: a mapping replaces these options; give --map OUR=THEIRS")
        reading = Reading(mapping_of(map_ or [], frame, clock or []), join, join_folders)
        made = import_logs(sources, kind, out, about, wishes, reading)
        _tell(out, made, "--map")
    else:
        made = import_runs(sources, cast(Kind, kind), out, about, wishes)
        _tell(out, made, "--column")


def _list(sources: list[Path], kind: str, folders: bool, join: str | None, boat: str | None) -> None:
    """The tables and fields of logs, and the options that names suggest, or what is taken by default."""
    from swamp_rl.boat import load_boat
    from swamp_rl.logs.import_logs import BINARY, as_one, read_logs
    from swamp_rl.logs.listing import fields_of, listing
    from swamp_rl.logs.proposal import proposal, taken_by_default

    if kind in ("mcap", "telemetry", "free-running"):
        raise UserError(f"--list: is not for --from {kind}; MCAP with CDR is --from rosbag")
    vessel, suggested = load_boat(boat or "swamp"), dict[str, list[str]]()
    alike: dict[Hashable, list[str]] = {}
    logs = read_logs(sources, kind, None, folders)
    for log in logs if join is None else [as_one(list(logs), join)]:
        for line in listing(log) if fields_of(log) not in alike else ():
            typer.echo(line)
        alike.setdefault(fields_of(log), []).append(clipped(log.name))
        binary = kind in BINARY
        suggested[log.name] = taken_by_default(kind, log, vessel) if binary else proposal(log, vessel)
    for first, *others in alike.values():
        if others:
            typer.echo(
                f"{and_others(others)}: the same tables and fields as {first}; name one alone for its values"
            )
    for line in _common(suggested):
        typer.echo(line)


def _common(suggested: dict[str, list[str]]) -> list[str]:
    """The lines that all logs share that have any, and the names of those without; by name of the log."""
    having = [lines for lines in suggested.values() if lines]
    if not having:
        return []
    if any(lines != having[0] for lines in having):
        return ["these logs differ in their columns: --list one at a time"]
    without = ", ".join(clipped(name) for name, lines in suggested.items() if not lines)
    return having[0] + [f"no column known by name: {without}; leave them out, or map them"] * bool(without)


def _tell(out: Path, made: "DatasetMeta", option: str) -> None:
    """Print how the rows of imported runs were changed, and how many there are; option: names columns."""
    told: dict[str, list[str]] = {}
    for run in made.runs:
        entries = run.model_extra or {}
        lines = [f"{key.replace('_', ' ')}: {entries[key]}" for key in NOTED if key in entries]
        lines += [*entries.get("cells_left_out", ()), *entries.get("rows_left_out", ())]
        lines += _origin(made, entries)
        for line in dict.fromkeys(lines):
            told.setdefault(line, []).append(str(run.file))
    for line, files in told.items():
        typer.echo(clipped(f"{and_others(files)}: {line}", LONGEST))
    for line in (_without_commands(out, made, option), _without_last_state(out, made)):
        if line:
            typer.echo(line)
    rows = sum(run.rows or 0 for run in made.runs)
    typer.echo(
        f"{out}: {counted(len(made.runs), 'run')}, {rows} rows at {made.sample_rate:g} Hz, {made.source}"
    )


def _origin(made: "DatasetMeta", entries: Mapping[str, Any]) -> list[str]:
    """A line with the origin of a run of several, and how far it is from that of the first run with one."""
    from swamp_rl.runs.local_frame import distance, origin_of

    origins = [origin_of(run.model_extra or {}) for run in made.runs]
    own, first = origin_of(entries), next((one for one in origins if one is not None), None)
    if own is None or first is None or len(made.runs) == 1:
        return []
    line = f"origin of north and east: {own[0]:.9g}, {own[1]:.9g}"
    if own != first:
        line += f", {distance(own, first) / 1000.0:.3g} km from {first[0]:.9g}, {first[1]:.9g}"
        line += "; positions about different origins do not compare (--origin sets one for all)"
    return [line]


def _without_commands(out: Path, made: "DatasetMeta", option: str) -> str:
    """A line if the first run, and so all that were imported alike, has no command of the dataset's boat."""
    from swamp_rl.boat import load_boat
    from swamp_rl.runs.columns import command_columns
    from swamp_rl.runs.dataset import own_boat
    from swamp_rl.runs.table import read_table

    boat, has = load_boat(own_boat(out)), read_table(out / str(made.runs[0].file)).columns
    commands = command_columns(boat)
    if any(name in has for name in commands):
        return ""
    return (
        f"{out}: no commands of boat {boat.name} ({', '.join(commands)}): diagnose and identify need them; "
        f"import with {option} {commands[0]}=THEIRS"
    )


def _without_last_state(out: Path, made: "DatasetMeta") -> str:
    """A line if runs are incomplete that one step more would have taken through the last gate: a log of
    observations and the actions that followed has no row of the state after the last action."""
    from swamp_rl.course.outcome import INCOMPLETE, passes_in_a_step
    from swamp_rl.runs import read_dataset

    if made.course is None or all(run.outcome != INCOMPLETE for run in made.runs):
        return ""
    dataset = read_dataset(out)
    course, breadth = dataset.course, dataset.boat.breadth
    assert course is not None
    ended = [run for run in dataset.runs if run.meta.outcome == INCOMPLETE]
    tracks = [(run.time, run.stacked(("north", "east"))) for run in ended]
    short = sum(passes_in_a_step(*track, course, breadth) for track in tracks)
    if not short:
        return ""
    return (
        f"{out}: {short} of {counted(len(dataset.runs), 'run')} end less than a step before the last gate of "
        f"{course.name}, so they are incomplete; log the state after the last action too (or --outcome "
        "success, if all runs passed it)"
    )


@runs_app.command()
def export(
    dataset: Folder,
    to: Annotated[Literal["minari", "lerobot", "mcap", "csv", "parquet"], typer.Option(help="The format.")],
    out: Annotated[Path, typer.Option(help="The new folder.")],
    boat: BoatOption = None,
) -> None:
    """Write a dataset for Minari, LeRobot (its layout 3.0), MCAP viewers, or as CSV or Parquet tables."""
    from swamp_rl.runs.export_dataset import export_runs

    count = export_runs(dataset, to, out, boat_for(dataset, boat))
    typer.echo(f"{out}: {counted(count, 'run')}")


def _pairs(option: str, given: list[str] | None) -> dict[str, str]:
    found: dict[str, str] = {}
    for word in given or ():
        ours, equals, theirs = word.partition("=")
        if not (ours and equals and theirs) or ours in found:
            raise UserError(
                f"{option} {word}: give each of our column names once, as in {option} heading=psi"
            )
        found[ours] = theirs
    return found


def _units(degrees: list[str] | None, unit: list[str] | None) -> dict[str, str]:
    from swamp_rl.runs.units import UNITS

    found = _pairs("--unit", unit)
    for name in degrees or ():
        if name in found:
            raise UserError(f"--degrees {name}: has a --unit already; give one of the two")
        found[name] = "deg"
    for name, asked in found.items():
        if asked not in UNITS:
            raise UserError(f"--unit {name}={asked}: known units are {', '.join(UNITS)}")
    return found
