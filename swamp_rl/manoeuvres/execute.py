"""Run trials in closed loop, all of them in one batch of boats that the compiled step advances together."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.flight import STEP, of_one_clock, sensing
from swamp_rl.guidance.heading import Limits
from swamp_rl.guidance.loop import Seen, closed_loop, seen_of
from swamp_rl.manoeuvres.approach import Area, approached, waypoints
from swamp_rl.manoeuvres.controller import (
    APPROACH,
    DONE,
    GAVE_UP,
    Controller,
    Phase,
    Trial,
)
from swamp_rl.manoeuvres.pull_out import pull_out
from swamp_rl.manoeuvres.reverse_spiral import reverse_spiral
from swamp_rl.manoeuvres.spiral import spiral
from swamp_rl.manoeuvres.steering import Steering, refuse_astern, steering, steering_limit
from swamp_rl.manoeuvres.steering_response import stable_gain
from swamp_rl.manoeuvres.stopping import stopping
from swamp_rl.manoeuvres.straight import straight
from swamp_rl.manoeuvres.turning_circle import turning_circle
from swamp_rl.manoeuvres.zig_zag import zig_zag
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.sensors import observe

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mark:
    """Since `time` [s] the trial has been in `phase`, number `number` of its kind, ordering `angle` [rad]."""

    time: float
    phase: str
    number: int
    angle: float


@dataclass
class Executed:
    """A trial as it went: states (T, S), measured channels (T, 6) at the times of the commands, commands
    (T, 2K), marks and notes.
    """

    trial: Trial
    track: Array
    measured: Array
    commands: Array
    marks: list[Mark]
    notes: tuple[str, ...]
    completed: bool


def controller(trial: Trial, boat: Boat, area: Area) -> Controller:
    """The controller of a trial, approach included; UserError for what this boat cannot be asked."""
    limit, length = steering_limit(boat), boat.length
    limits = Limits(limit, stable_gain(boat, trial, STEP))
    if trial.kind != "straight" and trial.kind != "stopping" and abs(trial.angle) > limit + 1e-9:
        raise UserError(
            f"{trial.kind}: angle {math.degrees(trial.angle):g} deg is beyond the "
            f"{math.degrees(limit):.1f} deg that boat {boat.name} steers; give a smaller angle"
        )
    if trial.astern or trial.kind == "stopping":
        refuse_astern(boat)
    if trial.kind == "straight":
        manoeuvre = straight(trial, length, limits)
    elif trial.kind == "reverse-spiral":
        manoeuvre = reverse_spiral(trial, length, limit)
    else:
        makers = {
            "turning-circle": turning_circle,
            "zig-zag": zig_zag,
            "spiral": spiral,
            "pull-out": pull_out,
            "stopping": stopping,
        }
        manoeuvre = makers[trial.kind](trial, length)
    return approached(trial, manoeuvre, area, length, limits)


@dataclass
class _Helm:
    """What steers one boat of the batch."""

    control: Controller
    steer: Steering
    steer_approach: Steering
    phase: Phase
    marks: list[Mark] = field(default_factory=list)

    def act(self, sensed: Seen) -> Array:
        before = self.phase
        order, self.phase = self.control(sensed, before)
        if not self.marks or (before.name, before.number) != (self.phase.name, self.phase.number):
            self.marks.append(Mark(sensed.time, self.phase.name, self.phase.number, order.angle))
        return (self.steer_approach if self.phase.name == APPROACH else self.steer)(order)

    @property
    def over(self) -> bool:
        return self.phase.name in (DONE, GAVE_UP)


def execute(boat: Boat, trials: Sequence[Trial], area: Area | None = None, seed: int = 0) -> list[Executed]:
    """Run the trials, each from rest at the home of its area, until it is over; STEP is their sample time.

    seed: of the gusts, trial i has seed + i. UserError, before anything runs, for what the boat cannot do.
    """
    area = area or Area()
    helms = [_helm(trial, boat, area) for trial in trials]
    params = parameters(boat, len(trials))
    home, entrance = waypoints(area, boat.length)[:2]
    heading = math.atan2(entrance.east - home.east, entrance.north - home.north)
    state = initial_state(params, np.tile([home.north, home.east, heading], (len(trials), 1)))
    return _sail(boat, trials, helms, params, state, seed)


def _helm(trial: Trial, boat: Boat, area: Area) -> _Helm:
    steer = steering(boat, trial.pattern)
    # Thrusters that all turn the same way do not steer, so that approach is sailed as the others are.
    approach = steering(boat, "opposed") if trial.pattern == "parallel" else steer
    return _Helm(controller(trial, boat, area), steer, approach, Phase(APPROACH, 0.0))


def _sail(
    boat: Boat,
    trials: Sequence[Trial],
    helms: list[_Helm],
    params: NDArray[Any],
    state: Array,
    seed: int,
) -> list[Executed]:
    commands, ends = np.zeros((len(trials), 2 * len(boat.thrusters))), np.full(len(trials), -1)
    sensed = sensing(params, STEP)

    def decide(states: list[Array]) -> tuple[Array, bool]:
        now, tick, channels = states[-1], len(states) - 1, sensed(states)
        for i in np.flatnonzero(ends < 0):
            commands[i] = helms[i].act(seen_of(tick * STEP, now[i], channels[i]))
            if helms[i].over:
                ends[i] = tick
        return commands, bool((ends >= 0).all())

    seeds = (seed + np.arange(len(trials))).astype(np.uint64)
    track, rows = closed_loop(boat, params, state, decide, seeds, STEP)
    measured = observe(track, of_one_clock(params), STEP)
    return [
        Executed(
            trials[i],
            track[i, : end + 1],
            measured[i, : end + 1],
            rows[i, : end + 1],
            helms[i].marks,
            helms[i].phase.notes,
            helms[i].phase.name == DONE,
        )
        for i, end in enumerate(ends.tolist())
    ]
