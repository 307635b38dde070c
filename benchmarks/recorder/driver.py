"""A session of the recorder driven by a rule: full throttle, and the bearing to the next gate as angle."""

import math
from pathlib import Path

import numpy as np
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.runs.schema import meta_of
from swamp_rl.simulator.state import EAST, HEADING, NORTH, YAW_RATE
from swamp_rl.teleop.afloat import Afloat
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.messages import Command
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.session import Session

PERIOD = 0.04  # s, of the page's commands


def session(folder: Path, level: str) -> Session:
    """A session of SWAMP at that level of disturbance which records into the folder."""
    boat = load_boat("swamp")
    meta = meta_of(boat, "swamp", 10.0, "scripted", course="camogli")
    berth = Berth(
        lambda level, senses: Afloat(GatesEnv(disturbances=level, observation=senses)),
        (level,),
        lambda: Recordings(folder, meta, lambda line: None),
    )
    return Session({"swamp": berth}, np.random.default_rng(1))


def drive(session: Session, start: float) -> float:
    """Drive from that time [s] until the run has ended; the time then."""
    gates, now = load_course("camogli").gates, start
    while session.phase not in ("ended", "saving"):
        boat = session.boat.now
        gate = gates[min(boat.passed, len(gates) - 1)].centre
        bearing = math.atan2(gate.east - boat.state[EAST], gate.north + 2.0 - boat.state[NORTH])
        error = math.remainder(bearing - boat.state[HEADING], 2.0 * math.pi)
        angle = float(np.clip(2.0 * error - 1.4 * boat.state[YAW_RATE], -1.0, 1.0))
        session.command(Command(type="command", throttle=1.0, angle=angle), now)
        now += PERIOD
    return now
