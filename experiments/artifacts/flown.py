"""Pilots flown in the episodes of recorded runs: from the same start, in the same weather."""

import numpy as np
from swamp_rl.envs.again import same_episode

from swamp_rl.boat import Boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.course import Course
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive
from swamp_rl.files import shipped_folders
from swamp_rl.pilots.arguments import Asked, opened
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.record import replayable
from swamp_rl.pilots.store import describe_pilot
from swamp_rl.runs import Run, RunMeta


def opened_for(asked: Asked, boat: Boat, step: float) -> Pilot:
    """The pilot, where it was made for that boat and that time between decisions [s], or does not tell.

    UserError for any other, and for one that is missing or damaged.
    """
    try:
        made = None if asked.folder is None else describe_pilot(asked.folder).made
        pilot = opened(asked)
    except UserError as error:
        if asked.folder in shipped_folders("pilots").values():
            raise UserError(f"{str(error).rpartition(';')[0]}; install swamp-rl again") from error
        raise
    if made is not None and made.boat_sha256 != boat_digest(boat):
        other = f"the boat {made.boat}" if made.boat != boat.name else f"another version of {made.boat}"
        raise UserError(
            f"{asked.folder}: was made for {other}, the runs shown are of {boat.name}; name runs of its boat"
        )
    if made is not None and abs(made.step / step - 1.0) > 1e-6:
        raise UserError(
            f"{asked.folder}: decides every {made.step:g} s, the runs have a row every {step:g} s; name "
            "runs of its step"
        )
    return pilot


def flown(pilot: Pilot, name: str, run: Run, boat: Boat, course: Course, step: float) -> Run:
    """The run of a pilot called `name` in the episode of `run`, as it would be recorded."""
    make, seed = same_episode(run, boat, course, step), run.meta.seed or 0
    alone = drive(pilot, make, np.array([seed])).run(0, run.name, step)
    boats = make(1, ("north",))
    boats.reset(options={"episodes": [seed]})
    began = replayable(boats, 0)
    boats.close()
    if isinstance(run.meta.disturbances, list):
        began |= {"level": (run.meta.model_extra or {}).get("level")}  # drawn from it, though not here
    told = {"seed": run.meta.seed, "outcome": alone.meta.outcome, "helm": "pilot", "pilot": name}
    return Run(alone.name, alone.columns, RunMeta.model_validate(began | told))
