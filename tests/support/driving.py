"""A person at the levers, as a rule: what the tests of the recorder drive with."""

import math
from pathlib import Path

import numpy as np
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.runs import DatasetMeta
from swamp_rl.runs.schema import meta_of
from swamp_rl.simulator.state import EAST, HEADING, NORTH, YAW_RATE
from swamp_rl.teleop.afloat import Afloat
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.lookout import Lookout
from swamp_rl.teleop.messages import Command
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.session import Session

BOAT = load_boat("swamp")


def meta(**changes: object) -> DatasetMeta:
    """What the tests record: runs of a programme, so never called human."""
    return meta_of(BOAT, "swamp", 10.0, "scripted", course="camogli", notes="Driven by a test.").model_copy(
        update=changes
    )


def recordings(folder: Path) -> Recordings:
    return Recordings(folder, meta(), lambda line: None)


def berth(folder: Path, level: str = "calm", course: str = "camogli") -> Berth:
    """The SWAMP's, that level the first of its levels."""

    def on_course(level: str, senses: tuple[str, ...]) -> Afloat:
        return Afloat(GatesEnv(course=course, disturbances=level, observation=senses))

    def kept() -> Recordings:
        return Recordings(folder, meta(course=course), lambda line: None)

    return Berth(on_course, tuple(dict.fromkeys((level, "calm", "standard", "severe"))), kept)


def session(
    folder: Path,
    level: str = "calm",
    pilots: dict[str, Pilot] | None = None,
    seed: int = 1,
    lookout: Lookout | None = None,
) -> Session:
    return Session({"swamp": berth(folder, level)}, np.random.default_rng(seed), pilots, lookout=lookout)


def aim(north: float, east: float, heading: float, yaw_rate: float, passed: int) -> float:
    """The angle lever that takes the boat through the gates of Camogli."""
    gate = ((8.0, 0.0), (22.0, 8.0))[min(passed, 1)]
    ahead = 0.45 * max(gate[0] - north - 1.5, 0.0)
    target = gate[0] - ahead if ahead > 0.0 else gate[0] + 2.0
    error = math.atan2(gate[1] - east, target - north) - heading
    error = math.remainder(error, 2.0 * math.pi) - 0.7 * yaw_rate
    return max(-1.0, min(1.0, 2.0 * error))


def command(session: Session, throttle: float = 1.0, **others: float) -> Command:
    """The levers of someone who looks at the boat."""
    state = session.boat.now.state
    angle = aim(state[NORTH], state[EAST], state[HEADING], state[YAW_RATE], session.boat.now.passed)
    return Command(type="command", throttle=throttle, angle=angle, **others)


def drive(session: Session, start: float = 0.0, seconds: float = 90.0) -> float:
    """Drive until the run has ended, 25 commands a second; the clock then."""
    now = start
    while session.phase not in ("ended", "saving") and now < start + seconds:
        session.command(command(session), now)
        now += 0.04
    return now


def accept(session: Session) -> str:
    name = session.accept()()
    session.accepted()
    return name
