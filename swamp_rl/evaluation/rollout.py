"""Drive many seeded episodes at once with one pilot, and keep what happened until each of them ended."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.one_thread import one_thread
from swamp_rl.runs import Run, RunMeta

Array = NDArray[Any]


class Pilot(Protocol):
    """What evaluation asks of a pilot; the levers (n, 2) are throttle and angle."""

    @property
    def senses(self) -> tuple[str, ...]:
        """Names of the observations it wants, in order."""

    def reset(self, n: int) -> None:
        """Begin n runs."""

    def keep(self, boats: Array) -> None:
        """Go on with the boats of the places `boats` (m,) alone, in that order, each with its memory."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""


class Supply(Protocol):
    """What evaluation asks of the batteries of n boats."""

    @property
    def start(self) -> Array:
        """State of charge [1] of each pack at the start of the episode, (n, packs)."""

    @property
    def drawn(self) -> Array:
        """Energy [J] drawn from each pack since then, (n, packs)."""


class Boats(Protocol):
    """What evaluation asks of a batch of n boats: a gymnasium VectorEnv that shows its boats."""

    @property
    def pose(self) -> Array:
        """North, east [m], heading [rad], (n, 3)."""

    @property
    def applied(self) -> Array:
        """What the actuators did, (n, 2K): azimuths [rad], then throttles [1]."""

    @property
    def supply(self) -> Supply | None:
        """The batteries, where their charge is counted."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict]:
        """`options["episodes"]` (n,) are the episodes' seeds; with `options["once"]` a boat that has ended
        lies still, for it has no other episode."""

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Observation, reward, terminated, truncated, info."""

    def close(self) -> None:
        """Free what it holds."""


WORTH_DROPPING = 0.25
"Share of the boats a pilot steers that have ended when it has to continue without them."

MakeBoats = Callable[[int, tuple[str, ...]], Boats]
"""Builds a batch of n boats that are observed by the given names."""


@dataclass(frozen=True)
class Rollout:
    """n episodes of up to T steps; what lies beyond an episode's own `steps` is not part of it."""

    seeds: Array
    "(n,) episode seeds"
    steps: Array
    "(n,) steps driven"
    outcome: Array
    "(n,) names of outcomes, 'success' among them"
    pose: Array
    "(n, T + 1, 3) north, east [m], heading [rad]"
    commands: Array
    "(n, T, 2) levers: throttle, angle [1]"
    throttle: Array
    "(n, T, K) what the pumps did [1]"
    returns: Array
    "(n,) sum of the rewards"
    drawn: Array | None = None
    "(n, packs) energy drawn from each pack [J], where its charge was counted"
    charge: Array | None = None
    "(n, packs) state of charge at the start [1], where it was counted"

    def track(self, i: int) -> Array:
        """Pose (steps + 1, 3) of episode i."""
        return self.pose[i, : self.steps[i] + 1]

    def levers(self, i: int) -> Array:
        """Commands (steps, 2) of episode i."""
        return self.commands[i, : self.steps[i]]

    def run(self, i: int, name: str, step: float) -> Run:
        """Episode i as a run of steps + 1 rows; the last row, where nothing was decided, keeps the levers."""
        track, levers = self.track(i), self.levers(i)
        levers = np.vstack([levers, levers[-1:]])
        columns = {
            "time": np.arange(len(track)) * step,
            "north": track[:, 0],
            "east": track[:, 1],
            "heading": wrapped(track[:, 2]),
            "joy_thrust": levers[:, 0],
            "joy_angle": levers[:, 1],
        }
        meta = RunMeta(seed=int(self.seeds[i]), outcome=str(self.outcome[i]))
        return Run(name, columns, meta)


@one_thread()
def drive(
    pilot: Pilot, make_boats: MakeBoats, seeds: Array, tick: Callable[[int], None] = lambda ended: None
) -> Rollout:
    """One episode for each of `seeds` (n,), all in one batch; `tick` hears each step how many have ended.

    Boats that have ended are soon neither sailed nor steered. How an episode goes does not depend on the
    others.
    """
    boats = make_boats(len(seeds), pilot.senses)
    try:
        return _drive(pilot, boats, np.asarray(seeds), tick)
    finally:
        boats.close()


def _drive(pilot: Pilot, boats: Boats, seeds: Array, tick: Callable[[int], None]) -> Rollout:
    n = len(seeds)
    observation, _ = boats.reset(options={"episodes": seeds, "once": True})
    pilot.reset(n)
    steered = np.arange(n)
    running = np.ones(n, dtype=bool)
    steps = np.zeros(n, dtype=np.int64)
    outcome = np.full(n, "", dtype=object)
    returns = np.zeros(n)
    pose, commands, throttle = [boats.pose.copy()], [], []
    while running.any():
        going = running[steered]
        if going.mean() <= 1.0 - WORTH_DROPPING:
            pilot.keep(np.flatnonzero(going))
            steered = steered[going]
        levers = np.zeros((n, 2))
        levers[steered] = pilot.act(observation[steered])
        observation, rewards, terminated, truncated, info = boats.step(levers)
        returns += np.where(running, rewards, 0.0)
        pose.append(boats.pose.copy())
        commands.append(levers)
        throttle.append(np.split(boats.applied, 2, axis=1)[1].copy())
        steps += running
        ended = running & (terminated | truncated)
        outcome[ended] = info["outcome"][ended] if ended.any() else ""
        running &= ~ended
        tick(n - int(running.sum()))
    poses, actions, throttles = (np.stack(values, axis=1) for values in (pose, commands, throttle))
    drawn, charge = (None, None) if boats.supply is None else (boats.supply.drawn, boats.supply.start)
    return Rollout(seeds, steps, outcome.astype(str), poses, actions, throttles, returns, drawn, charge)
