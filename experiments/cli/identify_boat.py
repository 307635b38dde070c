"""`swamp-rl identify boat`: the numbers of a boat file fitted to recorded runs."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.identify import identify_app
from swamp_rl.experiments.cli.options import IgnoreOption


@identify_app.command("boat")
def identify_boat(
    dataset: Annotated[list[Path], typer.Argument(help="Folders of runs of one boat.")],
    out: Annotated[Path, typer.Option(help="The .yaml file to write; the report goes beside it as .html.")],
    boat: Annotated[
        str | None,
        typer.Option(
            "--boat", help="The boat file to start from: a name or a file; by default the dataset's."
        ),
    ] = None,
    holdout: Annotated[
        Path | None, typer.Option(help="Runs held out to measure the errors; by default every third run.")
    ] = None,
    positions: Annotated[
        bool, typer.Option("--positions", help="Also fit the positions of the thrusters.")
    ] = False,
    ignore: IgnoreOption = None,
) -> None:
    """Fit a boat file's masses, damping, thrust and lags to runs, under priors, and write the boat file."""
    from swamp_rl.runs.dataset import own_boat

    boat = boat or str(own_boat(dataset[0]))
    typer.echo(f"identifying {boat} from {', '.join(map(str, dataset))}")
    from swamp_rl.experiments.cli.progress import progress

    from swamp_rl.boat_fit.identify import identify_boat as identify
    from swamp_rl.boat_fit.report import (
        error_columns,
        error_rows,
        gains_sentence,
        held_out_sentence,
        next_runs,
        summary,
    )
    from swamp_rl.criticism.progress import LOG
    from swamp_rl.unfinished import locked

    with progress(LOG), locked(out.absolute()):
        found = identify(dataset, boat, out, holdout, positions, ignore or [])
    for line in summary(found):
        typer.echo(f"  {line}")
    typer.echo(f"  {held_out_sentence(found)}")
    horizon, *columns = error_columns(found)
    typer.echo(f"  {horizon}: {', '.join(columns)}, m")
    for horizon, *errors in error_rows(found):
        typer.echo(f"  {horizon:>7}: {', '.join(errors)}")
    typer.echo(f"  {gains_sentence(found)}")
    for line in next_runs(found):
        typer.echo(f"  to record next: {line}")
    typer.echo(f"{out}, {out.with_suffix('.html')} ({found.elapsed:.0f} s)")
