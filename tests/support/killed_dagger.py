"""A DAgger that is killed at random instants and started again, until it has ended.

    python -m tests.support.killed_dagger FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

from pathlib import Path

import numpy as np
import torch
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.hindsight import with_gates

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.pilots import Pilot
from swamp_rl.pilots.callbacks import Log
from swamp_rl.pilots.dagger import DaggerSettings, fit_dagger
from swamp_rl.pilots.record import drive_episodes
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import Run
from tests.support.killed import lead_lives

BOAT, COURSE = load_boat("swamp"), load_course("camogli")
SETTINGS = DaggerSettings.model_validate(
    {"learner": {"kind": "cloning", "epochs": 6}, "rounds": 4, "runs": 2, "trials": 10, "seed": 2}
)


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    """Disturbed as in the rounds."""
    return GatesVectorEnv(n, disturbances="standard", observation=senses)


def look(run: Run) -> Run:
    """With the gates that are sensed."""
    return with_gates(run, COURSE)


def demonstrated() -> list[Run]:
    """Two runs of the scripted pilot."""
    pilot = ScriptedPilot(0)
    pilot.reset(2)
    runs = drive_episodes(boats(2, pilot.senses), pilot, BOAT, 2**31 + np.arange(2), 0.1)
    return [look(run) for run in runs]


def trained(
    checkpoint: Path | None,
    settings: DaggerSettings = SETTINGS,
    log: Log = lambda number, values: None,
) -> Pilot:
    """The pilot of all rounds, from the checkpoint on where there is one."""
    return fit_dagger(demonstrated(), boats, BOAT, look, settings, checkpoint=checkpoint, log=log)


if __name__ == "__main__":
    torch.set_num_threads(1)  # a fork has none of its parent's other threads, and would wait for them
    trained(None, SETTINGS.model_copy(update={"rounds": 1}))  # whatever is imported and compiled for it
    lead_lives(trained)
