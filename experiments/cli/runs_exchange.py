"""`swamp-rl runs import` and `runs export`: datasets from and for the programmes of others."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer
from swamp_rl.experiments.cli.place import place_of
from swamp_rl.experiments.cli.runs import BoatOption, Folder, boat_for, runs_app

from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from swamp_rl.runs.schema import RunMeta

Rate = Annotated[
    float | None, typer.Option(min=1e-3, max=1e6, help="Rows a second, where there are no times to use.")
]
Resample = Annotated[
    float | None, typer.Option(min=1e-3, max=1e6, help="Rows a second to make of uneven ones.")
]


@runs_app.command("import")
def import_(
    sources: Annotated[list[Path], typer.Argument(help="Files, or folders of them.")],
    from_: Annotated[
        Literal["csv", "parquet", "mcap", "telemetry", "free-running", "dataflash", "ulog", "rosbag"] | None,
        typer.Option("--from", help="What they are; by default as their suffix tells."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="The new dataset.")] = None,
    boat: Annotated[str | None, typer.Option(help="Whose runs they are; by default swamp.")] = None,
    source: Annotated[
        Literal["measured", "simulated", "human", "scripted", "learned"] | None,
        typer.Option(help="Who or what made them; by default measured."),
    ] = None,
    course: Annotated[str | None, typer.Option(help="A name in configs/courses, or a file.")] = None,
    notes: Annotated[str | None, typer.Option(help="Kept in dataset.yaml.")] = None,
    outcome: Annotated[
        Literal["success", "failed", "auto"] | None,
        typer.Option(help="How the runs ended; auto, and the default with --course: by the course."),
    ] = None,
    group: Annotated[str | None, typer.Option(help="Day or place of runs that share their weather.")] = None,
    column: Annotated[
        list[str] | None, typer.Option(metavar="OUR=THEIRS", help="What a column is called there.")
    ] = None,
    degrees: Annotated[
        list[str] | None, typer.Option(metavar="OUR", help="A column in degrees there.")
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(metavar="OUR=UNIT", help="A column in deg, deg/s, kn, km/h, km, cm, ms, rpm, percent …"),
    ] = None,
    drop: Annotated[list[str] | None, typer.Option(metavar="THEIRS", help="A column to leave out.")] = None,
    rate: Rate = None,
    resample: Resample = None,
    origin: Annotated[
        str | None,
        typer.Option(metavar="LATITUDE,LONGITUDE", help="Of north and east; by default the first place."),
    ] = None,
    topic: Annotated[str | None, typer.Option(help="Of an MCAP file with several.")] = None,
    sender: Annotated[int | None, typer.Option(help="Of telemetry of several hulls.")] = None,
    repair: Annotated[
        bool, typer.Option("--repair", help="End a free-running test before its first hole.")
    ] = False,
    map_: Annotated[
        list[str] | None,
        typer.Option(
            "--map", metavar="OUR=EXPRESSION", help="A column from those there, or a .yaml of them."
        ),
    ] = None,
    frame: Annotated[
        Literal["ned", "enu"] | None,
        typer.Option(help="Of x, y, yaw, vx, vy, u, v, r; by default ned, of ROS enu."),
    ] = None,
    clock: Annotated[
        list[str] | None,
        typer.Option(metavar="A~B", help="One quantity of two tables: shift the clock of the second."),
    ] = None,
    join: Annotated[
        str | None, typer.Option(metavar="NAME", help="The files are tables of one run of this name.")
    ] = None,
    bad_rows: Annotated[
        Literal["refuse", "cut", "split"],
        typer.Option(help="Refuse the file, keep the longest stretch without them, or keep all stretches."),
    ] = "refuse",
    list_: Annotated[
        bool, typer.Option("--list", help="Print tables, rates and fields, to write a mapping; nothing else.")
    ] = False,
    fill: Annotated[
        float, typer.Option(min=0.0, max=60.0, help="Seconds without rows that --resample interpolates.")
    ] = 0.0,
) -> None:
    """Make a dataset of the logs of a boat: tables, messages, telemetry, free-running tests."""
    from swamp_rl.logs.import_logs import BINARY, Reading, import_logs
    from swamp_rl.logs.mapping import mapping_of
    from swamp_rl.runs.import_dataset import About, Kind, import_runs, kind_of
    from swamp_rl.runs.import_foreign import Wishes

    wishes = Wishes(
        _pairs("--column", column),
        _units(degrees, unit),
        tuple(drop or ()),
        rate,
        resample,
        place_of(origin),
        bad_rows,
        fill,
    )
    about = About(boat, source, course, notes, outcome, group, topic, sender, repair)
    kind = from_ or kind_of(sources)
    if list_:
        _list(sources, kind)
        return
    if out is None:
        raise UserError("--out: the new dataset has no name; give one, or --list")
    if kind in BINARY or map_ or frame or clock or join:
        if wishes.renamed or wishes.dropped or wishes.rate:
            raise UserError("--column, --drop, --rate: a mapping says it all; give --map OUR=THEIRS")
        reading = Reading(mapping_of(map_ or [], frame, clock or []), join)
        made = import_logs(sources, kind, out, about, wishes, reading)
    else:
        made = import_runs(sources, cast(Kind, kind), out, about, wishes)
    for run in made.runs:
        _tell(run)
    rows = sum(run.rows or 0 for run in made.runs)
    typer.echo(f"{out}: {len(made.runs)} runs, {rows} rows at {made.sample_rate:g} Hz, {made.source}")


def _list(sources: list[Path], kind: str) -> None:
    """The tables and fields of logs."""
    from swamp_rl.logs.import_logs import paths_of, read_log
    from swamp_rl.logs.listing import listing

    if kind in ("mcap", "telemetry", "free-running"):
        raise UserError(f"--list: is not for --from {kind}; MCAP with CDR is --from rosbag")
    for path in paths_of(sources, kind):
        for line in listing(read_log(path, kind)):
            typer.echo(line)


def _tell(run: "RunMeta") -> None:
    """What was done to the rows of an imported run."""
    told = run.model_extra or {}
    for key in ("times", "joined", "clocks", "resampled", "commands", "not_imported"):
        if key in told:
            typer.echo(f"{run.file}: {key.replace('_', ' ')}: {told[key]}")
    for line in told.get("rows_left_out", ()):
        typer.echo(f"{run.file}: {line}")


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
    typer.echo(f"{out}: {count} runs")


def _pairs(option: str, given: list[str] | None) -> dict[str, str]:
    found: dict[str, str] = {}
    for word in given or ():
        ours, equals, theirs = word.partition("=")
        if not (ours and equals and theirs) or ours in found:
            raise UserError(f"{option} {word}: give each of our names once, as in {option} heading=psi")
        found[ours] = theirs
    return found


def _units(degrees: list[str] | None, unit: list[str] | None) -> dict[str, str]:
    from swamp_rl.runs.import_foreign import UNITS

    found = _pairs("--unit", unit)
    for name in degrees or ():
        if name in found:
            raise UserError(f"--degrees {name}: has a --unit already; give one of the two")
        found[name] = "deg"
    for name, asked in found.items():
        if asked not in UNITS:
            raise UserError(f"--unit {name}={asked}: known units are {', '.join(UNITS)}")
    return found
