"""`swamp-rl record`: people drive a boat, simulated or at a link, and their runs become a dataset."""

import logging
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from swamp_rl.experiments.cli.link import OriginOption
from swamp_rl.experiments.cli.options import CourseOption
from swamp_rl.experiments.cli.place import place_of

if TYPE_CHECKING:
    from swamp_rl.teleop.afloat import Afloat
    from swamp_rl.teleop.berth import Berth

BOATS = ("swamp", "swamp-light")
"Boats that the page offers where none is asked for."
LEVELS = ("calm", "standard", "severe")
"Levels of disturbance that the page offers, after the one that was asked for."


Out = Annotated[Path, typer.Option(help="The folder of runs, new or to be continued.")]
Boats = Annotated[
    list[str] | None,
    typer.Option(
        "--boat",
        help="A name in configs/boats, or a boat file; may be repeated, to offer a choice. By "
        f"default {' and '.join(BOATS)}, with --link {BOATS[0]}. Runs of the first go to OUT, of others "
        "to OUT/BOAT.",
    ),
]
Level = Annotated[
    str, typer.Option(help="Initial disturbance level: a name in configs/disturbances, or a file.")
]
Pilots = Annotated[
    list[str] | None,
    typer.Option(
        "--pilot",
        metavar="MODEL",
        help="A trained pilot's folder, sb3:MODEL.zip, onnx:PILOT.onnx or MODULE:CLASS[=FOLDER]; may be "
        "repeated.",
    ),
]
Port = Annotated[int, typer.Option(min=0, max=65535, help="TCP port; 0: any free one.")]
Host = Annotated[str, typer.Option(help="Address to listen on; one that other machines reach needs --token.")]
Token = Annotated[str | None, typer.Option(help="Password that the page asks for.")]
Scripted = Annotated[
    bool, typer.Option("--scripted", help="Mark the runs as scripted: a program operates the page.")
]
LinkTo = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Drive the vehicle that answers there, not a simulated boat; an address as `swamp-rl "
        "vehicle --address` takes it.",
    ),
]


def record(
    out: Out,
    course: CourseOption = "camogli",
    boat: Boats = None,
    disturbances: Level = "calm",
    pilot: Pilots = None,
    port: Port = 8000,
    host: Host = "127.0.0.1",
    token: Token = None,
    scripted: Scripted = False,
    link: LinkTo = None,
    origin: OriginOption = None,
) -> None:
    """Drive a boat by joypad, keyboard or touch, from a web page, and keep the runs."""
    import numpy as np
    from swamp_rl.experiments.artifacts.flown import opened_for
    from swamp_rl.experiments.synthetic.cases import RTK

    from swamp_rl.boat import load_boat
    from swamp_rl.extras import missing
    from swamp_rl.link.helm import PERIOD
    from swamp_rl.pilots.arguments import asked_pilot
    from swamp_rl.teleop.guard import Guard

    try:
        from swamp_rl.teleop.hub import Hub
        from swamp_rl.teleop.server import bound, serve
    except ModuleNotFoundError as error:
        raise missing(f"the recorder needs {error.name}", "people") from error
    from swamp_rl.teleop.lookout import Lookout
    from swamp_rl.teleop.session import Session

    guard = Guard(host, token)
    source = "scripted" if scripted else "human"
    boats = boat or list(BOATS if link is None else BOATS[:1])
    _refuse_of_the_other_kind(link, boats, disturbances, pilot, origin)
    asked_for = [asked_pilot(text) for text in pilot or []]
    names = _names(one.folder or Path(one.name) for one in asked_for)
    pilots = {
        name: opened_for(one, load_boat(offered), PERIOD)
        for offered in boats
        for name, one in zip(names, asked_for, strict=True)
    }
    with ExitStack() as stack:
        if link is None:
            berths = _berths(out, boats, course, disturbances, source)
        else:
            answering = _vehicle(out, boats[0], course, source, link, origin)
            berths = dict(zip(_names([Path(boats[0])]), [stack.enter_context(answering)], strict=True))
        listening = bound(host, port)  # before the session opens the folder of runs
        lookout = Lookout(RTK if link is None else None)  # telemetry has the noise of its sensors
        session = Session(berths, np.random.default_rng(), pilots, lookout=lookout)
        session.warm()
        logging.basicConfig(format="swamp-rl: %(message)s", level=logging.WARNING)
        try:
            serve(Hub(session, source), guard, listening, lambda address: typer.echo(f"drive at {address}"))
        except (KeyboardInterrupt, SystemExit):
            pass  # how a recorder is stopped: by Ctrl-C, or by whoever started it
        finally:
            stack.close()  # the motors are stopped before anything waits for the disk
            session.close()
    for kept in session.opened:
        typer.echo(f"{kept.folder}: {kept.sentence()}")


def _refuse_of_the_other_kind(
    link: str | None, boats: list[str], disturbances: str, pilot: list[str] | None, origin: str | None
) -> None:
    """UserError for an option of the simulator with --link, and for one of the link without it."""
    from swamp_rl.errors import UserError

    if link is None:
        if origin is not None:
            raise UserError("--origin: is the place of a vehicle's course; give --link too, or leave it out")
        return
    if len(boats) > 1:
        raise UserError("--link: one vehicle answers at an address; give one --boat")
    if disturbances != "calm":
        raise UserError("--link: a vehicle has the weather that there is; leave out --disturbances")
    if pilot:
        raise UserError("--link: a person drives; leave out --pilot, or use `swamp-rl helm PILOT --link`")


@contextmanager
def _vehicle(
    folder: Path, boat: str, course: str, source: str, link: str, origin: str | None
) -> Iterator["Berth"]:
    """The vehicle at an address, its motors switched off at the end. UserError where none answers."""
    import time

    from swamp_rl.envs.aboard import Measured

    from swamp_rl.boat import load_boat
    from swamp_rl.link.addresses import addresses
    from swamp_rl.link.helm import PATIENCE, Latest, await_first, stop
    from swamp_rl.link.sensor_line import CAMOGLI
    from swamp_rl.link.socket_link import no_answer, socket_link
    from swamp_rl.link.vehicle import refuse_other_thrusters
    from swamp_rl.teleop.berth import Berth
    from swamp_rl.teleop.linked import Linked
    from swamp_rl.teleop.recordings import Recordings

    known, place = load_boat(boat), place_of(origin) or CAMOGLI
    refuse_other_thrusters(known)
    ends, measured = addresses(link, len(known.thrusters)), Measured(boat=boat, course=course)
    meta = _meta(boat, course, source, f"Driven from the recorder's page over the link {ends.text}.")
    with socket_link(ends) as line:
        if not await_first(line, Latest(place), time.monotonic):
            raise no_answer(ends, PATIENCE)
        vehicle = Linked(line, measured, ends.text, place)
        try:
            yield Berth(
                lambda level, senses: vehicle, ("unknown",), lambda: Recordings(folder, meta, typer.echo)
            )
        finally:
            stop(line, len(known.thrusters))


def _berths(
    out: Path, boats: Sequence[str], course: str, disturbances: str, source: str
) -> "dict[str, Berth]":
    """By name, the first in `out` and others in folders of it; what cannot be sailed is refused before
    anything is written."""
    berths: dict[str, Berth] = {}
    for name, asked in zip(_names(map(Path, boats)), boats, strict=True):
        berths[name] = _berth(out / name if berths else out, asked, course, disturbances, source)
    return berths


def _berth(folder: Path, boat: str, course: str, disturbances: str, source: str) -> "Berth":
    """UserError where the boat does not fit the course or the first level."""
    from swamp_rl.envs.single import GatesEnv

    from swamp_rl.teleop.afloat import Afloat
    from swamp_rl.teleop.berth import Berth
    from swamp_rl.teleop.recordings import Recordings

    def make_craft(level: str, senses: tuple[str, ...]) -> Afloat:
        return Afloat(GatesEnv(boat=boat, course=course, disturbances=level, observation=senses))

    make_craft(disturbances, ("north",))
    levels = [disturbances, *(name for name in LEVELS if name != disturbances and _fits(make_craft, name))]
    by = " by a program" if source == "scripted" else ""
    meta = _meta(boat, course, source, f"Driven from the recorder's page{by}.")
    return Berth(make_craft, tuple(levels), lambda: Recordings(folder, meta, typer.echo))


def _names(paths: Iterable[Path]) -> list[str]:
    """What pilots or boats are called: after their folders or files, numbered where two have the same."""
    from swamp_rl.names import is_yaml

    names: list[str] = []
    for path in paths:
        place = path.resolve()
        name = re.sub(r"[^\w.-]", "_", place.stem if is_yaml(place) else place.name)[:60]
        same = sum(taken.partition(" ")[0] == name for taken in names)
        names.append(f"{name} {same + 1}" if same else name)
    return names


def _meta(boat: str, course: str, source: str, notes: str) -> Any:
    from swamp_rl.boat import load_boat
    from swamp_rl.runs import DatasetMeta

    vehicle = load_boat(boat)
    return DatasetMeta.model_validate(
        {
            "vehicle": boat,
            "mass": vehicle.mass,
            "draught": vehicle.draught,
            "water_density": vehicle.water_density,
            "sample_rate": 10.0,
            "source": source,
            "course": course,
            "notes": notes,
        }
    )


def _fits(make_craft: "Callable[[str, tuple[str, ...]], Afloat]", level: str) -> bool:
    """Whether the boat has the thrusters that a level disturbs."""
    from swamp_rl.errors import UserError

    try:
        make_craft(level, ("north",))
    except UserError:
        return False
    return True
