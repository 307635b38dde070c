"""`swamp-rl runs`: check and summarise a folder of recorded runs."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.outputs import mark_of, refuse_suffix, refuse_to_replace

from swamp_rl.counted import counted
from swamp_rl.errors import UserError

runs_app = typer.Typer(help="Check, show, import and export recorded runs.", no_args_is_help=True)

Folder = Annotated[Path, typer.Argument(help="A folder of runs.")]
BoatOption = Annotated[
    str | None, typer.Option("--boat", help="Boat of the runs, where no dataset.yaml names it.")
]


def boat_for(folder: Path, boat: str | None) -> str | None:
    """The boat named for a folder, None where the folder's own description names it too; UserError where that
    names another one.
    """
    from swamp_rl.boat import load_boat
    from swamp_rl.boat.digest import boat_digest
    from swamp_rl.runs.dataset import META, boat_of, parse

    if boat is None or not (folder / META).exists():
        return boat
    description, _ = parse(folder)
    if description is None:
        return boat
    if boat_digest(load_boat(boat)) != boat_digest(boat_of(folder, description.meta)):
        named = f"{folder / META} names {description.meta.vehicle}"
        raise UserError(f"--boat {boat}: {named}, whose numbers differ; leave --boat out")
    return None


@runs_app.command()
def check(folder: Folder, boat: BoatOption = None) -> None:
    """List every fault by file, row and column; exit code 1 if there is any."""
    from swamp_rl.runs import inspect_dataset

    found = inspect_dataset(folder, boat_for(folder, boat))
    for note in found.notes:
        typer.echo(f"note: {note}")
    for fault in found.faults:
        typer.echo(f"fault: {fault}")
    count = len(found.faults)
    rows = sum(len(run.columns[name]) for run in found.runs for name in list(run.columns)[:1])
    typer.echo(
        f"{folder}: {counted(len(found.runs), 'run')}, {rows} rows, "
        + (counted(count, "fault") if count else "no faults")
    )
    if count:
        raise typer.Exit(1)


@runs_app.command()
def show(
    folder: Folder,
    out: Annotated[
        Path | None, typer.Option(help="PNG file of the tracks; by default results/FOLDER-tracks.png.")
    ] = None,
    boat: BoatOption = None,
) -> None:
    """Print a table of the runs and draw their tracks."""
    from rich.console import Console
    from swamp_rl.experiments.reports.runs import draw_tracks, run_table

    from swamp_rl.runs import read_dataset

    place = out or Path("results") / f"{folder.resolve().name}-tracks.png"
    refuse_suffix("--out", place, ".png")
    refuse_to_replace(f"--out {place}", place, [folder])
    dataset = read_dataset(folder, boat_for(folder, boat))
    Console(markup=False).print(run_table(dataset))
    try:
        draw_tracks(dataset, place, mark_of(folder))
    except UserError as error:
        raise UserError(f"{error}, or name another place with --out") from error
    typer.echo(f"tracks drawn in {place}")
