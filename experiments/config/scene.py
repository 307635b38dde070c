"""Everything an experiment names, read and found to be sound."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.task import Task
from swamp_rl.experiments.config.made import made_of
from swamp_rl.experiments.config.named_files import levels_of
from swamp_rl.experiments.config.schema import Experiment, senses_in

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.load import boat_chain
from swamp_rl.course import Course, course_files, fitted, limited, load_course
from swamp_rl.errors import UserError
from swamp_rl.files import find_config
from swamp_rl.names import free_name
from swamp_rl.pilots.made_for import check_made_for
from swamp_rl.pilots.own import is_named, own_class
from swamp_rl.simulator.reference import reference_of


@dataclass(frozen=True)
class Scene:
    """An experiment with its boat and its course, the limits of whose episodes are the experiment's."""

    experiment: Experiment
    boat: Boat
    course: Course

    @property
    def levels(self) -> dict[str, str]:
        """Levels of disturbance by the name they are reported under."""
        return {Path(level).stem: level for level in self.experiment.evaluation.levels}

    @property
    def seeds(self) -> NDArray[np.int64]:
        """(n,) seeds of the evaluated episodes."""
        plan = self.experiment.evaluation
        return plan.seed + np.arange(plan.episodes)

    def boats_at(
        self, level: str | None, at_once: bool = False
    ) -> Callable[[int, tuple[str, ...]], GatesVectorEnv]:
        """What builds batches of boats on this course at a level of disturbance.

        A boat that has ended starts anew in the next step, or `at_once`, in the same.
        """
        mode = AutoresetMode.SAME_STEP if at_once else AutoresetMode.NEXT_STEP

        def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
            return GatesVectorEnv(
                n,
                boat=self.boat,
                course=self.course,
                disturbances=level,
                observation=senses,
                reward=self.experiment.reward,
                step=self.experiment.step,
                autoreset_mode=mode,
            )

        return make


def read_scene(experiment: Experiment, given: Path | str = "experiment") -> Scene:
    """The files that an experiment, `given` so, names; UserError for the first that is wrong."""
    boat = load_boat(experiment.boat)
    course = fitted(load_course(experiment.course), boat.length, reference_of(boat).speed)
    course = limited(
        course,
        experiment.time_limit,
        experiment.bounds,
        experiment.depth.model_dump() if experiment.depth else None,
    )
    scene = Scene(experiment, boat, course)
    for level in (None, *levels_of(experiment)):
        scene.boats_at(level)(1, ("north",)).close()
    for name, plan in experiment.pilots.items():
        place = plan.options.get("folder", plan.options.get("file", name))
        check_made_for(place, made_of(plan.kind, plan.options), boat, experiment.step)
        asked = [(f"pilots.{name}.options.senses", senses) for senses in senses_in(plan.options)]
        senses = getattr(own_class(plan.kind), "senses", None) if is_named(plan.kind) else None
        if isinstance(senses, list | tuple):
            asked.append((f"pilots.{name}.kind: {plan.kind}.senses", senses))
        for where, senses in asked:
            try:
                Task.read(boat=boat, course=course, observation=senses)
            except UserError as error:
                raise UserError(f"{given}: {where}: {error}") from error
    return scene


def config_files(scene: Scene) -> dict[str, Path]:
    """The boat, course and level files that an experiment names, by the path that a copy of each is kept at.
    Each stands before the one that it extends, which has a number where its name is taken.

    UserError where two levels have the same name.
    """
    files: dict[str, Path] = {}
    boats = [file for file, _ in reversed(boat_chain(scene.experiment.boat))]
    for kind, chain in (("boats", boats), ("courses", course_files(scene.experiment.course))):
        for file in chain:
            files[free_name(f"{kind}/{file.name}", files)] = file
    for level in levels_of(scene.experiment):
        file = find_config("disturbances", level)
        if not files.setdefault(f"disturbances/{file.name}", file).samefile(file):
            raise UserError(f"{file}: another of the disturbances has the same name; rename one of the two")
    return files
