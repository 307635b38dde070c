"""One row of a live stream: what was commanded and what was measured at a time."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import fixed_thrusters
from swamp_rl.simulator.sensors import CHANNELS

Array = NDArray[np.float64]

POSE = ("north", "east", "heading")


@dataclass(frozen=True)
class Sample:
    """time [s]; commands (2K,) azimuths [rad] then throttles [1], held until the next sample; measured (6,)
    north, east [m], heading [rad], surge, sway [m/s over ground], yaw rate [rad/s], NaN where there is none.
    """

    time: float
    commands: Array
    measured: Array


def samples_of(run: Run, boat: Boat) -> Iterator[Sample]:
    """The rows of a recorded run. UserError where it has no pose or lacks a command of the boat."""
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    missing = [name for name in POSE if name not in run.columns]
    if missing:
        raise UserError(f"run {run.name}: column {missing[0]} is missing; a monitor needs {', '.join(POSE)}")
    absent = np.full(len(run.time), np.nan)
    measured = np.stack([run.columns.get(name, absent) for name in CHANNELS], axis=1)
    for time, command, row in zip(run.time, commands, measured, strict=True):
        yield Sample(float(time), command, row)
