"""`swamp-rl mission`: simulated mission legs, with power, current and charge."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer


def mission(
    file: Annotated[str, typer.Argument(help="A name in configs/missions, or a mission file.")],
    boat: Annotated[str | None, typer.Option("--boat", help="Boat to use in place of the mission's.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="The folder for the report, its figure and data; none by default.")
    ] = None,
    even_if_empty: Annotated[
        bool,
        typer.Option("--even-if-empty", help="Continue below the reserve, until a pack is empty."),
    ] = False,
) -> None:
    """Simulate a mission's legs; power, current and charge of each battery pack, remaining range."""
    from swamp_rl.experiments.cli.progress import progress
    from swamp_rl.experiments.reports.mission import DATA, lines, write_mission

    from swamp_rl.boat import load_boat
    from swamp_rl.energy.fly import LOG, fly
    from swamp_rl.energy.mission import load_mission
    from swamp_rl.errors import errors_at
    from swamp_rl.replacement import refuse_to_replace

    asked, path = load_mission(file)
    if out is not None:
        refuse_to_replace(out, (DATA,))
    with errors_at(f"{path}: boat") if boat is None else nullcontext():
        sailed = load_boat(boat or asked.boat)
    with progress(LOG):
        flight = fly(sailed, asked, path, even_if_empty)
    for line in lines(flight):
        typer.echo(line)
    if out is not None:
        write_mission(out, flight)
        typer.echo(f"{out}: report.md, mission.json, mission.csv and mission.png")
