"""Record runs of the scripted pilot as a dataset."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, load_boat
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.errors import UserError
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.scripted import Habits, ScriptedPilot, Skill, habits_of
from swamp_rl.runs import Run, RunMeta, append_run, dataset_beside
from swamp_rl.runs.schema import meta_of

AT_ONCE = 64
"Boats in a batch; fixed, so that the first runs do not depend on how many are asked for."
ATTEMPTS = 20
"Largest number of episodes for each run asked for."
NOTES = (
    "Driven by the scripted pilot, a programme that imitates how people drove; no person was at the joypad."
)


class Named(Protocol):
    """A level of disturbance."""

    @property
    def name(self) -> str:
        """Of its file, or `none`."""


class Fleet(Protocol):
    """Protocol of the boats behind the environment."""

    @property
    def level(self) -> Named:
        """Their level of disturbance."""

    def drawn(self, i: int) -> dict[str, Any]:
        """`effects` and `gust_seed` of the episode of boat i."""


class Boats(Protocol):
    """Protocol of n boats: a gymnasium VectorEnv that resets a boat a step after its end."""

    @property
    def pose(self) -> Array:
        """North, east [m], heading [rad], (n, 3)."""

    @property
    def sensed_pose(self) -> Array:
        """As `pose`, but as the boats' sensors report it."""

    @property
    def velocity(self) -> Array:
        """Surge, sway [m/s], yaw rate [rad/s], (n, 3)."""

    @property
    def sensed_velocity(self) -> Array:
        """As `velocity`, but as the boats' sensors report it."""

    @property
    def commands(self) -> Array:
        """Commands of the thrusters, (n, 2K): azimuths [rad], then throttles [1]."""

    @property
    def applied(self) -> Array:
        """Actual azimuths and throttles, as `commands`."""

    @property
    def fleet(self) -> Fleet:
        """The boats behind the environment."""

    def reset(self, *, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """`options["episodes"]` (n,) are the episodes' seeds."""

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Observation, reward, terminated, truncated, info."""

    def close(self) -> None:
        """Release its resources."""


class Driver(Protocol):
    """Protocol of a pilot that has been reset."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""


class Wanted(NamedTuple):
    """Numbers of runs to be recorded: successful and failed ones."""

    good: int
    failed: int


MakeBoats = Callable[[int, tuple[str, ...]], Boats]
"""Builds a batch of n boats that are observed by the given names."""


def record_scripted(
    make_boats: MakeBoats,
    out: Path | str,
    *,
    boat: str | Path = "swamp",
    course: str = "camogli",
    count: int = 40,
    failed: int = 0,
    seed: int = 0,
    step: float = 0.1,
    habits: Habits | None = None,
    skills: Sequence[Skill] = ("usual",),
    tick: Callable[[int], None] = lambda good: None,
    new: bool = False,
) -> None:
    """Write the first `count` successful and the first `failed` failed runs into `out`.

    make_boats: builds boats of `boat` on `course` at `step` [s] with the disturbances of the runs. Each run
    stores seed, initial state and disturbances of its episode. With several `skills` there are as many of
    each, in the same episodes, and each run stores its skill; habits replaces those of the skills.
    `tick` is called with the number of successful runs. With `new`, no earlier dataset is replaced.
    UserError where the folder holds other data or the pilot hardly ever succeeds.
    """
    vehicle = load_boat(boat)
    meta = meta_of(vehicle, boat, 1.0 / step, "scripted", course=course, notes=NOTES)
    boats = make_boats(AT_ONCE, ScriptedPilot.senses)
    try:
        with dataset_beside(out, meta, new) as part:
            for number, skill in enumerate(skills):
                pilot = ScriptedPilot(seed, habits or habits_of(skill, vehicle.length), step)
                stored, prefix = ({"skill": skill}, f"{skill}-") if len(skills) > 1 else ({}, "")
                report = partial(_after, tick, number * count)
                _fill(part, boats, pilot, vehicle, Wanted(count, failed), seed, report, (stored, prefix))
    finally:
        boats.close()


def _after(tick: Callable[[int], None], before: int, good: int) -> None:
    tick(before + good)


def _fill(
    folder: Path,
    boats: Boats,
    pilot: ScriptedPilot,
    vehicle: Boat,
    wanted: Wanted,
    seed: int,
    tick: Callable[[int], None],
    named: tuple[Mapping[str, str], str],
) -> None:
    """Append runs until there are those `wanted`. named: their skill and prefix of names."""
    # Larger than any seed of an evaluation, so that no pilot is evaluated on its training data.
    episodes = np.random.default_rng(seed)
    good = bad = 0
    ends: Counter[str] = Counter()
    pilot.reset(AT_ONCE)
    for _ in range(1 + ATTEMPTS * (wanted.good + wanted.failed) // AT_ONCE):
        for run in drive_episodes(
            boats, pilot, vehicle, episodes.integers(2**31, 2**32, AT_ONCE), pilot.step
        ):
            succeeded = run.meta.outcome == "success"
            ends[str(run.meta.outcome)] += 1
            if good == wanted.good if succeeded else bad == wanted.failed:
                continue
            number, good, bad = good + bad + 1, good + succeeded, bad + (not succeeded)
            meta = run.meta.model_copy(update=named[0])
            append_run(folder, Run(f"{named[1]}run-{number:03d}", run.columns, meta))
            tick(good)
            if (good, bad) == wanted:
                return
        pilot.reset_boats(np.ones(AT_ONCE, dtype=bool))
    drawn = ", ".join(f"{count} {end}" for end, count in ends.most_common())
    raise UserError(
        f"the scripted pilot drove {good} good and {bad} failed runs, not {wanted.good} and {wanted.failed}; "
        f"its runs ended with {drawn}; ask for other numbers or disturbances, for a longer `time_limit`, or "
        "for a course of the boat's size: a file with "
        f"`extends: camogli` and `scale: {max(vehicle.length / SWAMP_LENGTH, 0.1):.1f}`"
    )


def drive_episodes(boats: Boats, pilot: Driver, vehicle: Boat, seeds: Array, step: float) -> list[Run]:
    """Return one episode per boat as a run named by its seed; the pilot must have been reset.

    A row holds the state as the sensors report it, the levers and commands held until the next row, and the
    actual azimuths and throttles. The last row repeats the levers before it.
    """
    observation, _ = boats.reset(options={"episodes": seeds})
    began = [replayable(boats, i) for i in range(len(seeds))]
    rows: list[list[Array]] = []
    runs: dict[int, Run] = {}
    while len(runs) < len(seeds):
        before = [boats.sensed_pose.copy(), boats.sensed_velocity.copy(), boats.applied.copy()]
        levers = pilot.act(observation)
        observation, _, terminated, truncated, info = boats.step(levers)
        rows.append([*before, levers, boats.commands.copy()])
        for i in np.flatnonzero(terminated | truncated).tolist():
            if i not in runs:
                last = [
                    boats.sensed_pose[i],
                    boats.sensed_velocity[i],
                    boats.applied[i],
                    levers[i],
                    boats.commands[i],
                ]
                parts = [np.array([*(row[j][i] for row in rows), last[j]]) for j in range(5)]
                meta = RunMeta(seed=int(seeds[i]), outcome=str(info["outcome"][i]), **began[i])
                runs[i] = Run(f"episode-{seeds[i]}", _columns(parts, vehicle, step), meta)
    return [runs[i] for i in range(len(seeds))]


def _columns(parts: list[Array], vehicle: Boat, step: float) -> dict[str, Array]:
    """Return the columns of the run format from pose, velocity, applied, levers and commands, each (T, ·).

    A fixed thruster has no column of its azimuth.
    """
    pose, velocity, applied, levers, commands = parts
    named = {
        "time": np.arange(len(pose)) * step,
        "north": pose[:, 0],
        "east": pose[:, 1],
        "heading": wrapped(pose[:, 2]),
        "surge": velocity[:, 0],
        "sway": velocity[:, 1],
        "yaw_rate": velocity[:, 2],
        "joy_thrust": levers[:, 0],
        "joy_angle": levers[:, 1],
    }
    angles, levels = zip(*(thruster.command_columns for thruster in vehicle.thrusters), strict=True)
    channels = [(j, channel) for j, channel in enumerate((*angles, *levels)) if channel is not None]
    named |= {channel: commands[:, j] for j, channel in channels}
    return named | {f"applied_{channel}": applied[:, j] for j, channel in channels}


def replayable(boats: Boats, i: int) -> dict[str, Any]:
    """Return initial state and disturbances of boat i's run: with its commands they suffice to replay it."""
    names = ("north", "east", "heading", "surge", "sway", "yaw_rate")
    drawn = boats.fleet.drawn(i)
    return {
        "initial_state": dict(
            zip(names, [*boats.pose[i].tolist(), *boats.velocity[i].tolist()], strict=True)
        ),
        "disturbances": drawn.pop("effects"),
        **drawn,
        "level": boats.fleet.level.name,
    }
