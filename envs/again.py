"""The episode that a recorded run was sailed in, begun again for another pilot."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.depth import without_depth
from swamp_rl.envs.task import Disturbances

from swamp_rl.boat import Boat
from swamp_rl.course import Course, Pose, limited
from swamp_rl.runs import Run

POSE = ("north", "east", "heading")
MakeAgain = Callable[[int, tuple[str, ...]], GatesVectorEnv]
"""Builds a batch of n boats that are observed by the given names."""


class _Again(GatesVectorEnv):
    """Boats whose gusts have one seed, whatever the seed of their episode."""

    gust_seed = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """As `GatesVectorEnv.reset`."""
        observations, info = super().reset(seed=seed, options=options)
        self.fleet.boats["gust_seed"] = self.gust_seed
        self.fleet.look(np.arange(self.num_envs), observations)
        return observations, info


def same_episode(run: Run, boat: Boat, course: Course, step: float) -> MakeAgain:
    """What builds boats that begin, at rest, in the run's first pose, disturbed and blown as it was.

    Where a run tells no effects or no seed of its gusts, as a measured one, the boats meet no disturbance.
    UserError for effects that the boat cannot have.
    """
    effects, gust_seed = weather_of(run)
    depth = (run.meta.model_extra or {}).get("water_depth")
    if course.depth and isinstance(depth, float):
        effects = without_depth(effects)
        course = limited(course, None, None, depth)
    first = dict(zip(POSE, run.pose[0].tolist(), strict=True)) | (run.meta.initial_state or {})
    pose = Pose.model_construct(**{name: first[name] for name in POSE})
    spread = Pose(north=0.0, east=0.0, heading=0.0)
    start = course.start.model_copy(update={"pose": pose, "spread": spread})
    there = course.model_copy(update={"start": start})

    def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        boats = _Again(n, boat=boat, course=there, disturbances=effects, observation=senses, step=step)
        boats.gust_seed = gust_seed
        return boats

    return make


def weather_of(run: Run) -> tuple[Disturbances, int]:
    """The run's effects with their numbers and the seed of its gusts; none and 0 where it does not tell."""
    effects, gust_seed = run.meta.disturbances, (run.meta.model_extra or {}).get("gust_seed")
    if isinstance(effects, list) and isinstance(gust_seed, int) and 0 <= gust_seed < 2**64:
        return effects, gust_seed
    return None, 0
