"""Pilots flown in the episodes of recorded runs: from the same start, in the same weather."""

import numpy as np
from swamp_rl.envs.again import same_episode
from swamp_rl.envs.line_of_sight_damping import suited
from swamp_rl.envs.observation import observed
from swamp_rl.experiments.artifacts.stages import say
from swamp_rl.experiments.config.made import made_of

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.errors import UserError, errors_at
from swamp_rl.evaluation import drive
from swamp_rl.files import shipped_folders
from swamp_rl.pilots.arguments import Asked, opened
from swamp_rl.pilots.made_for import check_made_for
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.record import replayable
from swamp_rl.runs import Run, RunMeta


def opened_for(asked: Asked, boat: Boat, step: float, named_by: str = "boat") -> Pilot:
    """The pilot, to drive that boat at that time between decisions [s]; a note where it was made for another.

    named_by: as for `check_made_for`. UserError as there, and for a pilot that is missing or damaged, or
    observes what there is not.
    """
    try:
        made = made_of(asked.kind, asked.options if asked.folder is None else {"folder": asked.folder})
        pilot = suited(opened(asked), boat, step)
    except UserError as error:
        if asked.folder in shipped_folders("pilots").values():
            raise UserError(f"{str(error).rpartition(';')[0]}; install swamp-rl again") from error
        raise
    with errors_at(asked.folder or (asked.kind if ":" in asked.kind else asked.name)):
        observed(pilot.senses)
    if (line := check_made_for(asked.place or asked.name, made, boat, step, named_by)) is not None:
        say(line)
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
    metadata = {"seed": run.meta.seed, "outcome": alone.meta.outcome, "helm": "pilot", "pilot": name}
    return Run(alone.name, alone.columns, RunMeta.model_validate(began | metadata))
