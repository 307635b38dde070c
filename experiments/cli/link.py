"""`swamp-rl vehicle` and `swamp-rl helm`: a virtual vehicle on the network, and a pilot that controls one."""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from swamp_rl.experiments.cli.options import BoatOption, CourseOption, seed_option
from swamp_rl.experiments.cli.place import place_of

from swamp_rl.counted import counted

if TYPE_CHECKING:
    from swamp_rl.envs.aboard import Aboard

    from swamp_rl.link.addresses import Addresses
    from swamp_rl.link.helm import Voyage
    from swamp_rl.link.vehicle import Vehicle

AddressOption = Annotated[
    str,
    typer.Option(
        "--address",
        help="A network A.B.C.0/24 with the boat's last bytes (.201 …), or A.B.C.D:PORT for one address and "
        "ports from there.",
    ),
]
OriginOption = Annotated[
    str | None,
    typer.Option(
        metavar="LATITUDE,LONGITUDE", help="Geographic origin of the course; by default off Camogli."
    ),
]


def vehicle(
    boat: Annotated[str, typer.Argument(help="A name in configs/boats, or a boat file.")] = "swamp",
    address: AddressOption = "127.0.0.0/24",
    course: CourseOption = "camogli",
    log: Annotated[
        Path | None, typer.Option(help="A new file for its telemetry, for `runs import --from telemetry`.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=0.1, max=1e6, help="Duration (s); by default until Ctrl-C.")
    ] = None,
    timeout: Annotated[
        float, typer.Option(min=0.0, help="Seconds without a command until a pump stops; inf: never.")
    ] = 1.0,
    steps_per_turn: Annotated[
        int | None,
        typer.Option(
            min=1, max=10**8, help="Azimuth encoder counts per turn; by default 495411 (thesis table 5.5)."
        ),
    ] = None,
    noise: Annotated[
        bool,
        typer.Option("--noise", help="Add the noise of a GPS receiver without corrections and of an AHRS."),
    ] = False,
    seed: Annotated[int, seed_option("Seed of gusts and noise.")] = 0,
    origin: OriginOption = None,
) -> None:
    """Simulate the boat's network interface: thruster modules and sensors."""
    import time

    import numpy as np

    from swamp_rl.boat import load_boat
    from swamp_rl.course import fitted, load_course
    from swamp_rl.link.addresses import addresses
    from swamp_rl.link.vehicle import Conduct, Vehicle
    from swamp_rl.navigation.sensors import Sensors
    from swamp_rl.runs.thruster_telemetry import STEPS_PER_TURN

    known = load_boat(boat)
    pose = fitted(load_course(course), known.length).start.pose
    conduct = Conduct(
        timeout,
        steps_per_turn or STEPS_PER_TURN,
        Sensors() if noise else None,
        seed,
        time.time_ns() // 1000,
        _origin(origin),
    )
    start = np.array([pose.north, pose.east, pose.heading])
    ends = addresses(address, len(known.thrusters))
    Vehicle(known, ends, start, conduct).advance(0.2)  # compiles what would halt the first second
    _serve(Vehicle(known, ends, start, conduct), log, seconds)


def _serve(vehicle: "Vehicle", log: Path | None, seconds: float | None) -> None:
    """Answer for `seconds` or until Ctrl-C; print the addresses, at the end what was ignored."""
    from swamp_rl.link.serve import endpoints, serve, telemetry_log

    with endpoints(vehicle) as sockets, telemetry_log(log) as lines:
        modules, recipient = vehicle.addresses.modules, vehicle.addresses.recipient
        first, last = modules[0], modules[-1]
        typer.echo(
            f"{vehicle.boat.name}: modules at {first[0]}:{first[1]} to {last[0]}:{last[1]}, telemetry to "
            f"{recipient[0]}:{recipient[1]}; Ctrl-C ends it"
        )
        with suppress(KeyboardInterrupt, SystemExit):  # how a vehicle is switched off
            serve(vehicle, sockets, lines, lambda: seconds is not None and vehicle.time >= seconds)
    typer.echo(f"{vehicle.time:.1f} s; ignored: {_counted(vehicle.ignored)}")


def helm(
    pilot: Annotated[
        str,
        typer.Argument(
            metavar="PILOT",
            help="A trained pilot's folder or name, line-of-sight, sb3:MODEL.zip, onnx:PILOT.onnx or "
            "MODULE:CLASS[=FOLDER].",
        ),
    ],
    link: Annotated[
        str, typer.Option("--link", help="The vehicle's address, as `swamp-rl vehicle --address` takes it.")
    ] = "127.0.0.0/24",
    boat: BoatOption = "swamp",
    course: CourseOption = "camogli",
    log: Annotated[Path | None, typer.Option(help="A new dataset of measurements and commands.")] = None,
    seconds: Annotated[
        float | None,
        typer.Option(min=0.1, max=1e6, help="Longest duration (s); by default until the course ends."),
    ] = None,
    priority: Annotated[
        bool,
        typer.Option(
            "--priority", help="Request real-time scheduling, for which the system may require root."
        ),
    ] = False,
    origin: OriginOption = None,
) -> None:
    """Let a pilot control the vehicle at an address, at 10 Hz, until the course ends."""
    import numpy as np
    from swamp_rl.envs.aboard import Aboard
    from swamp_rl.experiments.artifacts.flown import opened_for

    from swamp_rl.boat import load_boat
    from swamp_rl.link.addresses import addresses
    from swamp_rl.link.helm import PATIENCE, PERIOD
    from swamp_rl.link.priority import schedule_in_real_time
    from swamp_rl.link.socket_link import no_answer
    from swamp_rl.link.vehicle import refuse_other_thrusters
    from swamp_rl.pilots.arguments import asked_pilot

    if log is not None:
        _refuse_log(log)
    known, place = load_boat(boat), _origin(origin)
    refuse_other_thrusters(known)
    ends = addresses(link, len(known.thrusters))
    asked = asked_pilot(pilot)
    bridge = Aboard(opened_for(asked, known, PERIOD), boat=known, course=course)
    bridge.decide(0.0, np.zeros(6))  # compiles what would delay the first command
    bridge.begin()
    if priority:
        schedule_in_real_time()
    voyage = _drive(bridge, ends, len(known.thrusters), seconds, place)
    if voyage.outcome is None and not voyage.rows:
        raise no_answer(ends, PATIENCE)
    _report(voyage, bridge)
    if log is not None:
        _write_log(log, voyage, boat, course, asked.kind)
    if voyage.outcome is None:
        raise no_answer(ends, PATIENCE)


def _drive(
    bridge: "Aboard", ends: "Addresses", thrusters: int, seconds: float | None, place: tuple[float, float]
) -> "Voyage":
    """The voyage until its course has ended, `seconds` are over, the telemetry is lost, or Ctrl-C."""
    import math
    import time

    from swamp_rl.link.helm import Voyage, helm
    from swamp_rl.link.socket_link import socket_link

    voyage = Voyage()
    with socket_link(ends) as line:
        try:
            helm(line, bridge, thrusters, time.monotonic, seconds or math.inf, place, voyage)
        except (KeyboardInterrupt, SystemExit):
            voyage.outcome = "interrupted"
    return voyage


def _refuse_log(log: Path) -> None:
    """UserError for a log that could not be written once the voyage is over."""
    from swamp_rl.errors import UserError

    if log.exists() or log.is_symlink():
        raise UserError(f"{log}: already exists; the log is a new dataset, name another folder")
    home = next(folder for folder in log.absolute().parents if folder.exists())
    if not home.is_dir() or not os.access(home, os.W_OK | os.X_OK):
        raise UserError(f"{log}: {home} is not a folder that may be written to; name another one for the log")


def _report(voyage: "Voyage", bridge: "Aboard") -> None:
    from swamp_rl.link.voyage_log import lateness_figures, start_text

    late = {name: f"{1e3 * value:.3g} ms" for name, value in lateness_figures(voyage).items()}
    typer.echo(
        f"{voyage.outcome or 'telemetry lost'} after {len(voyage.lateness)} commands; lateness "
        f"{late['mean']} on average, {late['p99']} at the 99th percentile, {late['max']} at most"
    )
    if voyage.rows:
        passed = f"{bridge.passed} of {counted(len(bridge.course.gates), 'gate')} passed"
        typer.echo(f"{passed}; {start_text(voyage, bridge.course)}")
    typer.echo(
        f"periods missed: {voyage.missed}, without fresh telemetry: {voyage.silent}; "
        f"packets ignored: {voyage.ignored}"
    )


def _write_log(log: Path, voyage: "Voyage", boat: str, course: str, kind: str) -> None:
    from swamp_rl.boat import load_boat
    from swamp_rl.link.voyage_log import write_voyage
    from swamp_rl.runs.import_dataset import About

    source: Literal["scripted", "learned"] = "scripted" if kind == "line-of-sight" else "learned"
    about = About(boat=boat, source=source, course=course, notes="Driven over the vehicle's link.")
    made = write_voyage(log, voyage, load_boat(boat), about)
    typer.echo(
        f"{log}: {counted(len(made.runs), 'run')}, {counted(sum(run.rows or 0 for run in made.runs), 'row')}"
    )


def _counted(ignored: Mapping[str, int]) -> str:
    """Datagrams by the reason for which they were ignored."""
    return ", ".join(f"{count} {reason}" for reason, count in sorted(ignored.items())) or "none"


def _origin(text: str | None) -> tuple[float, float]:
    from swamp_rl.link.sensor_line import CAMOGLI

    return place_of(text) or CAMOGLI
