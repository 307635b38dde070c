"""What an environment is made of, single or batched: its arguments, read and found to fit together."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self, TypedDict, Unpack

from gymnasium.spaces import Box
from swamp_rl.envs.depth import refuse_depth
from swamp_rl.envs.observation import CHARGE, Observed, observation_space, observed
from swamp_rl.envs.own_terms import OwnTerm, own_term
from swamp_rl.envs.reward import DEFAULTS, weights_of

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.applicable import refuse_inapplicable
from swamp_rl.boat.drawn import refuse_without_battery
from swamp_rl.course import Course, fitted, limited, load_course
from swamp_rl.effects import Level, load_disturbances
from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.simulator.reference import size_of
from swamp_rl.whole_number import whole_number

Disturbances = str | Path | Sequence[Mapping[str, Any]] | None

SHORTEST_STEP, LONGEST_STEP = 1e-3, 1.0  # s
MOST_STEPS = 10**9


class TaskArguments(TypedDict, total=False):
    """Arguments that both environments take, by name; each may be left out."""

    boat: str | Path | Boat
    "A name in `configs/boats`, a path, or the thing itself; `swamp`."
    course: str | Path | Course
    "As `boat`; `camogli`. One that names a boat is scaled to this one, see `swamp_rl.course.fit`."
    disturbances: Disturbances
    "A level by name or path, or a list of effects; none."
    observation: Sequence[str] | None
    "Names of `envs.observation.SENSES`, or `module:function`; the first twelve."
    reward: Mapping[str, float] | None
    "Weights by name of `envs.reward.REWARD`, or `module:function`; others stay as they are."
    time_limit: float | None
    "In place of the course's [s]."
    bounds: Mapping[str, float] | None
    "Edges in place of the course's [m]: `south`, `north`, `west`, `east`, or some of them."
    depth: float | Mapping[str, Any] | None
    "Of the water in place of the course's [m]: a number, or `{uniform: [least, most]}`."
    step: float
    "Time of a step [s]; 0.1."
    max_episode_steps: int | None
    """A time limit in steps; the earlier of the two holds. `gymnasium.make` keeps it for its own wrapper, so
    that `time_left` counts to `time_limit` alone."""


@dataclass(frozen=True)
class Task:
    """The arguments, read."""

    boat: Boat
    course: Course
    "With the limits of the episode."
    level: Level
    observed: Observed
    weights: Mapping[str, float]
    "Of the built-in terms of the reward."
    step: float
    max_episode_steps: int | None
    own_rewards: tuple[tuple[float, OwnTerm], ...] = field(default=())
    "Terms of one's own with their weights."

    @property
    def observation_space(self) -> Box:
        """Of one boat."""
        return observation_space(self.observed, len(self.course.gates), self.steps_of_limit * self.step)

    @property
    def frames_per_second(self) -> float:
        """At which a film of every step is as fast as the boat; whole where a second is whole steps."""
        return round(1.0 / self.step, 6)

    @property
    def steps_of_limit(self) -> int:
        """Steps to the course's time limit, the last one whole."""
        return math.ceil(self.course.time_limit / self.step - 1e-9)

    @property
    def last_tick(self) -> int:
        """Steps to the earlier of the two time limits."""
        return min(self.steps_of_limit, self.max_episode_steps or self.steps_of_limit)

    @classmethod
    def read(cls, **given: Unpack[TaskArguments]) -> Self:
        """UserError for an unknown argument, for what cannot be read, and for what does not fit."""
        refuse_unknown(given)
        boat, course = given.get("boat", "swamp"), given.get("course", "camogli")
        boat = boat if isinstance(boat, Boat) else load_boat(boat)
        course = course if isinstance(course, Course) else load_course(course)
        size = size_of(boat)
        course = fitted(course, size.length, size.speed)
        level = load_disturbances(given.get("disturbances"), boat.thruster_names, size)
        drawn = (entry.effect for entry in level.entries)
        refuse_inapplicable(boat, drawn, f"disturbances {level.name}", counted=True)
        course = limited(course, given.get("time_limit"), given.get("bounds"), given.get("depth"))
        refuse_depth(boat, course, level)
        asked = observed(given.get("observation"))
        if CHARGE in asked.names:
            refuse_without_battery(boat, f"observation: {CHARGE}")
        weights = weights_of(given.get("reward"))
        return cls(
            boat=boat,
            course=course,
            level=level,
            observed=asked,
            weights={name: weights[name] for name in DEFAULTS},
            step=_checked_step(given.get("step", 0.1)),
            max_episode_steps=_checked_steps(given.get("max_episode_steps")),
            own_rewards=tuple(
                (weight, own_term("reward", name)) for name, weight in weights.items() if name not in DEFAULTS
            ),
        )


def refuse_unknown(given: Mapping[str, Any], further: Sequence[str] = ()) -> None:
    """UserError for an argument by a name that neither a task nor, as `further`, its environment has."""
    known = (*TaskArguments.__annotations__, *further)
    for name in given:
        if name not in known:
            raise UserError(f"unknown argument {name!r}{nearest(name, known)}")


def _checked_step(step: Any) -> float:
    if not is_number(step) or not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise UserError(f"step: must be a time from {SHORTEST_STEP:g} to {LONGEST_STEP:g} s, not {step!r}")
    return float(step)


def _checked_steps(steps: Any) -> int | None:
    return None if steps is None else whole_number("max_episode_steps:", steps, 1, MOST_STEPS)
