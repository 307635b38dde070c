"""`swamp-rl runs`: whether a folder of recorded runs is right, and what it holds."""

from pathlib import Path
from typing import Annotated

import typer

runs_app = typer.Typer(help="Check and look at recorded runs.", no_args_is_help=True)

Folder = Annotated[Path, typer.Argument(help="A folder of runs with its dataset.yaml.")]


@runs_app.command()
def check(folder: Folder) -> None:
    """Name every fault by file, row and column; exits with 1 if there is any."""
    from swamp_rl.runs import inspect_dataset

    found = inspect_dataset(folder)
    for note in found.notes:
        typer.echo(f"note: {note}")
    for fault in found.faults:
        typer.echo(f"fault: {fault}")
    count = len(found.faults)
    rows = sum(len(run.columns[name]) for run in found.runs for name in list(run.columns)[:1])
    typer.echo(
        f"{folder}: {len(found.runs)} runs, {rows} rows, "
        + (f"{count} fault{'s' * (count > 1)}" if count else "no faults")
    )
    if count:
        raise typer.Exit(1)


@runs_app.command()
def show(
    folder: Folder,
    out: Annotated[
        Path | None, typer.Option(help="The PNG of the tracks; by default results/FOLDER-tracks.png.")
    ] = None,
) -> None:
    """Print a table of the runs and draw their tracks."""
    from rich.console import Console
    from swamp_rl.experiments.reports.runs import draw_tracks, run_table

    from swamp_rl.errors import UserError
    from swamp_rl.runs import read_dataset

    out = out or Path("results") / f"{folder.resolve().name}-tracks.png"
    if out.suffix.lower() != ".png":
        raise UserError(f"{out}: the tracks are drawn as PNG; end the name in .png")
    dataset = read_dataset(folder)
    Console().print(run_table(dataset))
    draw_tracks(dataset, out)
    typer.echo(f"tracks drawn in {out}")
