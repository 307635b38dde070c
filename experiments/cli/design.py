"""`swamp-rl design`: a pump-jet, a hull, and propellers matched to a hull, from design files."""

from pathlib import Path
from typing import Annotated

import typer

design_app = typer.Typer(
    help="Design a pump-jet or a hull, or match propellers to a hull.", no_args_is_help=True
)

File = Annotated[str, typer.Argument(metavar="DESIGN", help="A name in configs/designs, or a design file.")]
Out = Annotated[Path, typer.Option(help="The folder of the tables, the figure and the boat file.")]
Extended = Annotated[str, typer.Option("--boat", help="Base boat of the boat file that is written.")]


@design_app.command("pump-jet")
def pump_jet(design: File, out: Out, boat: Extended = "swamp") -> None:
    """Size a mixed-flow pump-jet for its thrust: velocity triangles, vanes, thrust and power curves."""
    from swamp_rl.experiments.reports.design_pump_jet import write_pump_jet

    _say(
        write_pump_jet(out, design, boat),
        out,
        "design.json, curve.csv, triangles.csv, pump_jet.png, boat.yaml",
    )


@design_app.command()
def hull(design: File, out: Out, boat: Extended = "swamp") -> None:
    """Draw a hull's lines; hydrostatics over draught, draught over load, righting levers."""
    from swamp_rl.experiments.reports.design_hull import write_hull

    _say(
        write_hull(out, design, boat),
        out,
        "design.json, hydrostatics.csv, load.csv, levers.csv, hull.png, boat.yaml",
    )


@design_app.command()
def match(design: File, out: Out) -> None:
    """Match propellers to a hull, and find the speed of best range."""
    from swamp_rl.experiments.reports.design_match import write_match

    _say(write_match(out, design), out, "design.json, propellers.csv, ranges.csv, match.png")


def _say(lines: list[str], out: Path, files: str) -> None:
    for line in lines:
        typer.echo(line)
    typer.echo(f"{out}: {files}, design.yaml")
