"""A recorder driven without a page: runs on a short course, what it left opened again and looked at."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.attack.syscalls import Ended

SEED = 0

COURSE = """
name: short
gates: [{name: only, centre: {north: 8.0, east: 0.0}, heading: 0.0, width: 4.0}]
start: {pose: {north: 0.0, east: 0.0, heading: 0.0}, spread: {north: 0.5, east: 0.5, heading: 0.1}}
bounds: {south: -12.0, north: 34.0, west: -15.0, east: 23.0}
buoy_radius: 0.2
time_limit: 2.0
"""


def record(case: Path) -> int:
    """Two runs driven and accepted, one between them discarded; an acceptance is tried three times."""
    from swamp_rl.errors import UserError

    try:
        game = recorder(case)
    except UserError as error:
        print("swamp-rl:", error, file=sys.stderr)
        return 2
    now, kept = 0.0, 0
    for keep in (True, False, True):
        now = driven(game, now)
        for _ in range(3 if keep and game.journal is not None else 0):
            try:
                save = game.accept()
                name = save()
            except UserError:
                game.not_accepted()
                continue
            game.accepted()
            print("accepted", name, flush=True)
            kept += 1
            break
        else:
            game.drop(again=False)
    try:
        game.close()
    except UserError as error:
        print("swamp-rl:", error, file=sys.stderr)
        return 2
    return 0


def write_course(case: Path) -> None:
    """The course that `recorder` sails on."""
    (case / "inputs").mkdir(parents=True)
    (case / "inputs" / "short.yaml").write_text(COURSE)


def warm(case: Path, drive: Callable[[Path], object]) -> None:
    """Compile, in the process that is forked, what each fork would compile anew."""
    write_course(case)
    drive(case)


def recorder(case: Path):
    """A session on a course that ends after two seconds, with its dataset in `case`/out."""
    from swamp_rl.envs.single import GatesEnv

    from swamp_rl.boat import load_boat
    from swamp_rl.runs import DatasetMeta
    from swamp_rl.teleop.afloat import Afloat
    from swamp_rl.teleop.berth import Berth
    from swamp_rl.teleop.recordings import Recordings
    from swamp_rl.teleop.session import Session

    boat, course = load_boat("swamp"), str(case / "inputs" / "short.yaml")
    particulars = {name: getattr(boat, name) for name in ("mass", "draught", "water_density")}
    meta = DatasetMeta(vehicle="swamp", sample_rate=10.0, source="scripted", course=course, **particulars)
    berth = Berth(
        lambda level, senses: Afloat(GatesEnv(course=course, disturbances=level, observation=senses)),
        ("calm",),
        lambda: Recordings(case / "out", meta, lambda line: None),
    )
    return Session({"swamp": berth}, np.random.default_rng(SEED))


def driven(game, now: float) -> float:
    """Drive a run to its end; where the disk refuses to begin it, let go of the lever once and give up."""
    from swamp_rl.teleop.messages import Command as Levers

    for _ in range(200):
        if game.phase == "ended" or (game.complaint() is not None and game.phase == "ready"):
            break
        game.command(Levers(type="command", throttle=1.0, angle=0.1), now)
        now += 0.1
    game.command(Levers(type="command", throttle=0.0, angle=0.0), now)
    return now + 0.1


def recorded(case: Path, ended: Ended) -> str | None:
    """What is wrong with a recorder's dataset, opened again."""
    from swamp_rl.runs import check_dataset, read_dataset
    from swamp_rl.teleop.rows import largest_difference

    accepted = {line.split()[1] for line in ended.out.splitlines() if line.startswith("accepted")}
    if not (case / "out" / "dataset.yaml").exists():
        return f"lost the dataset with {accepted}" if accepted else None
    recorder(case).close()
    if list((case / "out" / "unfinished").glob("run-*")):
        return "something unfinished stays"
    runs = {run.name: run for run in read_dataset(case / "out").runs} if accepted else {}
    if not accepted <= set(runs):
        return f"lost {accepted - set(runs)}"
    if accepted and (faults := check_dataset(case / "out")):
        return f"faults: {faults[0]}"
    if any(runs[name].meta.outcome == "interrupted" for name in accepted):
        return "an accepted run is marked as interrupted"
    if any(largest_difference(runs[name], "swamp") != 0.0 for name in accepted):
        return "an accepted run does not sail again to the bit"
    return None
