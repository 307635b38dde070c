"""`swamp-rl trial bollard` and `trial towed`: captive tests, the forces at an imposed speed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.options import BoatOption
from swamp_rl.experiments.cli.trial import trial_app

SWEEP = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]

Out = Annotated[
    Path, typer.Option(help="The folder of captive.csv; the analysis goes to its folder analysis.")
]
Sweep = Annotated[
    list[float] | None,
    typer.Option("--throttle", help="Throttle, 0 to 1; may be repeated. By default 0.1 to 1."),
]
Jets = Annotated[
    list[str] | None,
    typer.Option(
        help="Running thrusters: names such as bs,bp, or the number of the first ones; may be repeated."
    ),
]
Speed = Annotated[list[float], typer.Option(help="Speed of the carriage (m/s); may be repeated.")]
Astern = Annotated[bool, typer.Option("--astern", help="Thrust and tow astern.")]


@trial_app.command()
def bollard(
    out: Out,
    throttle: Sweep = None,
    jets: Jets = None,
    astern: Astern = False,
    boat: BoatOption = "swamp",
) -> None:
    """Bollard pull against throttle, of one thruster up to all."""
    _carry_out("bollard", out, boat, [0.0], throttle, jets or [], astern)


@trial_app.command()
def towed(
    out: Out,
    speed: Speed,
    throttle: Sweep = None,
    jets: Jets = None,
    astern: Astern = False,
    boat: BoatOption = "swamp",
) -> None:
    """Towing force with the thrusters running, and thrust deduction 1 - t (thesis eq. 7.1)."""
    _carry_out("towed", out, boat, speed, throttle, jets or [], astern)


def _carry_out(
    kind: str,
    out: Path,
    boat_name: str,
    speeds: Sequence[float],
    throttles: Sequence[float] | None,
    jets: Sequence[str],
    astern: bool,
) -> None:
    from swamp_rl.experiments.reports.captive import write_captive

    from swamp_rl.boat import load_boat
    from swamp_rl.manoeuvres.captive import captive_trial, thruster_sets
    from swamp_rl.runs.schema import ANALYSIS

    boat = load_boat(boat_name)
    points = captive_trial(boat, speeds, throttles or SWEEP, thruster_sets(boat, jets), astern)
    for line in write_captive(out, kind, boat, points, astern):
        typer.echo(line)
    typer.echo(f"{out}: captive.csv; {out / ANALYSIS}: report.md, analysis.json and a figure")
