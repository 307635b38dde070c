"""`swamp-rl record`: people drive a boat from a web page, and their runs become a dataset."""

import logging
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from swamp_rl.experiments.cli.options import CourseOption

if TYPE_CHECKING:
    from swamp_rl.teleop.afloat import Env, MakeEnv
    from swamp_rl.teleop.berth import Berth

BOATS = ("swamp", "swamp-light")
"Boats that the page offers where none is asked for."
LEVELS = ("calm", "standard", "severe")
"Levels of disturbance that the page offers, after the one that was asked for."


def record(
    out: Annotated[Path, typer.Option(help="The folder of runs, new or to be continued.")],
    course: CourseOption = "camogli",
    boat: Annotated[
        list[str] | None,
        typer.Option(
            "--boat",
            help="A name in configs/boats, or a boat file; may be repeated, to offer a choice. By default "
            f"{' and '.join(BOATS)}. Runs of the first go to OUT, of others to OUT/BOAT.",
        ),
    ] = None,
    disturbances: Annotated[
        str, typer.Option(help="Initial disturbance level: a name in configs/disturbances, or a file.")
    ] = "calm",
    pilot: Annotated[
        list[str] | None,
        typer.Option(
            "--pilot",
            metavar="MODEL",
            help="A trained pilot's folder, sb3:MODEL.zip, onnx:PILOT.onnx or MODULE:CLASS[=FOLDER]; may be "
            "repeated.",
        ),
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="TCP port; 0: any free one.")] = 8000,
    host: Annotated[
        str, typer.Option(help="Address to listen on; one that other machines reach needs --token.")
    ] = ("127.0.0.1"),
    token: Annotated[str | None, typer.Option(help="Password that the page asks for.")] = None,
    scripted: Annotated[
        bool, typer.Option("--scripted", help="Mark the runs as scripted: a program operates the page.")
    ] = False,
) -> None:
    """Drive a boat by joypad, keyboard or touch, from a web page, and keep the runs."""
    import numpy as np
    from swamp_rl.experiments.synthetic.cases import RTK

    from swamp_rl.errors import UserError
    from swamp_rl.pilots.arguments import asked_pilot, opened
    from swamp_rl.teleop.guard import Guard

    try:
        from swamp_rl.teleop.hub import Hub
        from swamp_rl.teleop.server import bound, serve
    except ModuleNotFoundError as error:
        raise UserError(f"{error.name} is missing; pip install 'swamp-rl[people]'") from error
    from swamp_rl.teleop.lookout import Lookout
    from swamp_rl.teleop.session import Session

    guard = Guard(host, token)
    source = "scripted" if scripted else "human"
    asked_for = [asked_pilot(text) for text in pilot or []]
    names = _names(one.folder or Path(one.name) for one in asked_for)
    pilots = dict(zip(names, map(opened, asked_for), strict=True))
    berths = _berths(out, boat or BOATS, course, disturbances, source)
    listening = bound(host, port)  # before the session opens the folder of runs
    session = Session(berths, np.random.default_rng(), pilots, lookout=Lookout(RTK))
    session.warm()
    logging.basicConfig(format="swamp-rl: %(message)s", level=logging.WARNING)
    try:
        serve(Hub(session, source), guard, listening, lambda address: typer.echo(f"drive at {address}"))
    except (KeyboardInterrupt, SystemExit):
        pass  # how a recorder is stopped: by Ctrl-C, or by whoever started it
    finally:
        session.close()
    for kept in session.opened:
        typer.echo(f"{kept.folder}: {kept.count} runs")


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

    from swamp_rl.teleop.berth import Berth
    from swamp_rl.teleop.recordings import Recordings

    def make_env(level: str | None, senses: tuple[str, ...]) -> "Env":
        return GatesEnv(boat=boat, course=course, disturbances=level, observation=senses)

    make_env(disturbances, ("north",))
    levels = [disturbances, *(name for name in LEVELS if name != disturbances and _fits(make_env, name))]
    meta = _meta(boat, course, source)
    return Berth(make_env, tuple(levels), lambda: Recordings(folder, meta, typer.echo))


def _names(paths: Iterable[Path]) -> list[str]:
    """What pilots or boats are called: after their folders or files, numbered where two have the same."""
    names: list[str] = []
    for path in paths:
        name = re.sub(r"[^\w.-]", "_", path.resolve().name.removesuffix(".yaml"))[:60]
        same = sum(taken.partition(" ")[0] == name for taken in names)
        names.append(f"{name} {same + 1}" if same else name)
    return names


def _meta(boat: str, course: str, source: str) -> Any:
    from swamp_rl.boat import load_boat
    from swamp_rl.runs import DatasetMeta

    vehicle = load_boat(boat)
    notes = "Driven from the recorder's page" + (" by a program." if source == "scripted" else ".")
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


def _fits(make_env: "MakeEnv", level: str) -> bool:
    """Whether the boat has the thrusters that a level disturbs."""
    from swamp_rl.errors import UserError

    try:
        make_env(level, ("north",))
    except UserError:
        return False
    return True
