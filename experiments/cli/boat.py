"""`swamp-rl boat new` and `boat check`: estimate a boat file from its main particulars, or check one."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.outputs import refuse_suffix

from swamp_rl.errors import UserError

boat_app = typer.Typer(help="Boat files: estimate a new one, or check one.", no_args_is_help=True)

HEAD = """Boat {name}, {kind}: by `swamp-rl boat new` from length, breadth, mass and thrust.
Every number is an estimate: `sd` is the standard deviation of its prior. Replace what was measured, with
provenance measured and its source; a bare number counts as assumed. SI units, radians; x is forward of
midship, y to starboard."""


@boat_app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the boat: letters, digits, _ and -, a letter first.")],
    kind: Annotated[
        str,
        typer.Option(
            help="twin-fixed, four-fixed, azimuth, four-azimuths, propeller-rudder, waterjet or outboard "
            "(stern drive)."
        ),
    ],
    length: Annotated[float, typer.Option(help="Length of the hull at the waterline (m).")],
    breadth: Annotated[float, typer.Option(help="Breadth of the boat, over both hulls (m).")],
    mass: Annotated[float, typer.Option(help="Mass in operating condition (kg).")],
    thrust: Annotated[
        float | None,
        typer.Option(help="Total bollard pull, full ahead (N); estimated from --top-speed by default."),
    ] = None,
    top_speed: Annotated[
        float | None, typer.Option(help="Speed at full thrust (m/s); estimated by default.")
    ] = None,
    draught: Annotated[
        float | None, typer.Option(help="Draught of the hull (m); estimated by default.")
    ] = None,
    demihull: Annotated[
        float | None,
        typer.Option(help="Breadth of each of two hulls (m), of a catamaran; one hull by default."),
    ] = None,
    fin: Annotated[
        float | None,
        typer.Option(help="Lateral area of skeg, fin or lower unit at the stern (m2); none by default."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="The file to write, NAME.yaml by default.")] = None,
) -> None:
    """Write an annotated boat file whose other numbers are estimated by published formulas."""
    import re
    import shlex

    from swamp_rl.experiments.reports.boat_check import raft_warning, turning_warning

    from swamp_rl.boat import load_boat
    from swamp_rl.boat.estimate import annotated, boat_file, of_sizes
    from swamp_rl.files import write_beside
    from swamp_rl.simulator import parameters

    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]{0,63}", name):
        raise UserError(
            f"{name!r}: a boat's name has letters from A to Z or a to z, digits, _ and -, a letter first, 64 "
            "at most"
        )
    path = out or Path(f"{name}.yaml")
    refuse_suffix("--out", path, ".yaml", ".yml")
    if path.exists():
        raise UserError(f"{path}: already exists; name another, or remove it")
    content = boat_file(name, kind, length, breadth, mass, thrust, top_speed, draught, fin, demihull)
    with write_beside(path) as part:
        part.write_text(annotated(content, HEAD.format(name=name, kind=kind)), encoding="utf-8")
        try:
            parameters(load_boat(part))
        except UserError as error:
            raise UserError(of_sizes(str(error).splitlines()[0].removeprefix(f"{part}: "))) from error
    draught, quoted = content["draught"]["value"], shlex.quote(str(path))
    typer.echo(f"{path}: {kind}, draught {draught:.3g} m; check it with: swamp-rl boat check {quoted}")
    try:
        boat = load_boat(path)
        warnings = [raft_warning(boat), turning_warning(boat)]
    except UserError as error:
        warnings = [str(error).splitlines()[0]]
    for warning in filter(None, warnings):
        typer.echo(f"{path}: warning: {warning}")


@boat_app.command()
def check(
    file: Annotated[str, typer.Argument(help="A boat file, or a name in configs/boats.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the report with figures; none by default.")
    ] = None,
) -> None:
    """List the provenance of a boat file's numbers; simulate its speeds, turning circles and stopping."""
    from swamp_rl.experiments.reports.boat_check import check_lines, sail, write_check

    from swamp_rl.boat import load_boat

    boat = load_boat(file)
    results = sail(boat)
    files = [] if out is None else write_check(out, boat, results)
    for line in check_lines(boat, results):
        typer.echo(line)
    if files:
        typer.echo(f"{out}: {', '.join(files)}")
