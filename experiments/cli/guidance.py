"""`swamp-rl follow`, `follow-vehicle`, `hold` and `capability`: guidance and station keeping, simulated."""

import math
from pathlib import Path
from typing import Annotated, Any

import typer
from swamp_rl.experiments.cli.options import BoatOption, seed_option

from swamp_rl.constants import DAY, FASTEST_WATER
from swamp_rl.errors import UserError

STRONGEST_WIND = 60.0  # m/s

Out = Annotated[
    Path, typer.Option(help="The folder of the run; report, figure and JSON go to its folder analysis.")
]
Level = Annotated[
    str | None, typer.Option("--disturbances", help="A name in configs/disturbances, or a file of them.")
]
Current = Annotated[float, typer.Option(min=0.0, max=FASTEST_WATER, help="Additional steady current (m/s).")]
CurrentTo = Annotated[float, typer.Option(help="Direction that the current sets to (deg from north).")]
Wind = Annotated[float, typer.Option(min=0.0, max=STRONGEST_WIND, help="Additional steady wind (m/s).")]
WindFrom = Annotated[float, typer.Option(help="Direction that the wind comes from (deg from north).")]
Seed = Annotated[int, seed_option("Seed of the disturbances and of the gusts.")]


def _sea(current: float, current_to: float, wind: float, wind_from: float) -> list[dict[str, Any]]:
    """The options of the sea as entries of effects."""
    for option, value in {"--current-to": current_to, "--wind-from": wind_from}.items():
        if not abs(value) <= 360.0:
            raise UserError(f"{option} {value:g}: a direction is from -360 to 360 deg")
    to, comes_from = math.radians(current_to), math.radians(wind_from)
    north, east = current * math.cos(to), current * math.sin(to)
    found: list[dict[str, Any]] = []
    if current:
        found.append({"effect": "current", "north": north, "east": east})
    if wind:
        found.append({"effect": "wind", "speed": wind, "from": comes_from})
    return found


def follow(
    path: Annotated[str, typer.Argument(metavar="PATH", help="A name in configs/paths, or a path file.")],
    out: Out,
    boat: BoatOption = "swamp",
    disturbances: Level = None,
    current: Current = 0.0,
    current_to: CurrentTo = 0.0,
    wind: Wind = 0.0,
    wind_from: WindFrom = 0.0,
    seed: Seed = 0,
) -> None:
    """Follow a path of lines, arcs, splines, lawn-mower lines or circles; cross-track error and energy."""
    from swamp_rl.experiments.reports.guidance import follow_path

    _say(follow_path(out, path, boat, disturbances, _sea(current, current_to, wind, wind_from), seed), out)


def follow_vehicle(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A run of the vehicle ahead, .csv or .parquet.")],
    out: Out,
    behind: Annotated[float, typer.Option(help="Distance to keep along its track (m).")],
    boat: BoatOption = "swamp",
    disturbances: Level = None,
    current: Current = 0.0,
    current_to: CurrentTo = 0.0,
    wind: Wind = 0.0,
    wind_from: WindFrom = 0.0,
    seed: Seed = 0,
) -> None:
    """Follow a vehicle along its track, at a distance; cross-track error, gap and energy."""
    from swamp_rl.experiments.reports.guidance import follow_leader

    sea = _sea(current, current_to, wind, wind_from)
    _say(follow_leader(out, run, behind, boat, disturbances, sea, seed), out)


def hold(
    out: Out,
    boat: BoatOption = "swamp",
    duration: Annotated[float, typer.Option(min=10.0, max=DAY, help="Duration (s).")] = 120.0,
    heading: Annotated[
        float | None, typer.Option(help="Heading (deg); by default that with the greatest margin.")
    ] = None,
    failed: Annotated[
        list[str] | None, typer.Option(help="A thruster that is out of service; may be repeated.")
    ] = None,
    disturbances: Level = None,
    current: Current = 0.0,
    current_to: CurrentTo = 0.0,
    wind: Wind = 0.0,
    wind_from: WindFrom = 0.0,
    seed: Seed = 0,
) -> None:
    """Keep station in current and wind; report if the thrusters cannot."""
    from swamp_rl.experiments.reports.guidance import hold_station

    sea = _sea(current, current_to, wind, wind_from)
    if heading is not None and not abs(heading) <= 360.0:
        raise UserError(f"--heading {heading:g}: a direction is from -360 to 360 deg")
    bow = None if heading is None else math.radians(heading)
    _say(hold_station(out, boat, duration, bow, failed or [], disturbances, sea, seed), out)


def capability(
    boat: Annotated[str, typer.Argument(metavar="BOAT", help="A name in configs/boats, or a boat file.")],
    out: Annotated[Path, typer.Option(help="The folder for the plot, its JSON and CSV.")],
    wind: Annotated[
        float,
        typer.Option(min=0.0, max=STRONGEST_WIND, help="Wind that is present with every current (m/s)."),
    ] = 0.0,
    current: Annotated[
        float,
        typer.Option(min=0.0, max=FASTEST_WATER, help="Current that is present with every wind (m/s)."),
    ] = 0.0,
    failed: Annotated[
        list[str] | None, typer.Option(help="A thruster that is out of service; may be repeated.")
    ] = None,
) -> None:
    """Plot the strongest current and wind that a boat can hold from each direction."""
    from swamp_rl.experiments.reports.capability import write_capability

    for line in write_capability(out, boat, wind, current, failed or []):
        typer.echo(line)
    typer.echo(f"{out}: capability.json, capability.csv and capability.png")


def _say(lines: list[str], out: Path) -> None:
    from swamp_rl.runs.schema import ANALYSIS

    for line in lines:
        typer.echo(line)
    typer.echo(f"{out}: the run; {out / ANALYSIS}: report.md, result.json, track.csv and track.png")
