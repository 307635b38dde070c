"""`swamp-rl identify waypoint-square`: paper 003's identification of a vehicle in surge, heave and yaw."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.identify import identify_app
from swamp_rl.experiments.cli.options import seed_option


@identify_app.command("waypoint-square")
def waypoint_square(
    vehicle: Annotated[
        str, typer.Argument(metavar="VEHICLE", help="A name in configs/vehicles, or a vehicle file.")
    ],
    out: Annotated[Path, typer.Option(help="The folder of the report, its figure and JSON.")],
    seed: Annotated[int, seed_option("Seed of the sensors' noise.")] = 0,
) -> None:
    """Simulate a vehicle on a waypoint square, identify it from its own log, and replay the log."""
    from swamp_rl.experiments.reports.waypoint_square import write_square

    for line in write_square(out, vehicle, seed):
        typer.echo(line)
    typer.echo(f"{out}: report.md, result.json and square.png")
