"""One recorded run in memory, and the views of it that learners and plots want."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.runs.schema import RunMeta

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """`columns`: float64 arrays of one length T by column name (SI, rad), in the file's order."""

    name: str
    columns: dict[str, Array]
    meta: RunMeta = field(default_factory=RunMeta)

    @property
    def time(self) -> Array:
        """(T,) s."""
        return self.columns["time"]

    @property
    def duration(self) -> float:
        """From the first row to the last, s."""
        return float(self.time[-1] - self.time[0])

    @property
    def pose(self) -> Array:
        """(T, 3) north [m], east [m], heading [rad]."""
        return self.stacked(("north", "east", "heading"))

    @property
    def joypad(self) -> Array:
        """(T, 2) joy_thrust and joy_angle; UserError where no joypad drove."""
        return self.stacked(("joy_thrust", "joy_angle"))

    @property
    def path_length(self) -> float:
        """Length of the track over ground, m."""
        return float(np.hypot(np.diff(self.columns["north"]), np.diff(self.columns["east"])).sum())

    def commands(self, thrusters: Iterable[str], fixed: Iterable[str] = ()) -> Array:
        """(T, 2K) azimuths or rudder angles [rad], then throttles or revolutions, ordered as `thrusters`.

        A `fixed` one has azimuth 0. A name with a column `propeller_` is a propeller with its rudder.
        """
        thrusters, fixed = tuple(thrusters), tuple(fixed)
        propellers = {name for name in thrusters if f"propeller_{name}" in self.columns}
        levels = [f"{'propeller' if name in propellers else 'throttle'}_{name}" for name in thrusters]
        throttles = self.stacked(levels)
        angles = np.zeros_like(throttles)
        turning = [index for index, name in enumerate(thrusters) if name not in fixed]
        names = [
            f"{'rudder' if thrusters[index] in propellers else 'azimuth'}_{thrusters[index]}"
            for index in turning
        ]
        angles[:, turning] = self.stacked(names)
        return np.hstack([angles, throttles])

    def stacked(self, names: Iterable[str]) -> Array:
        """(T, len(names)) columns side by side; UserError naming the first that the run does not have."""
        names = tuple(names)
        missing = [name for name in names if name not in self.columns]
        if missing:
            known = nearest(missing[0], self.columns)
            raise UserError(f"run {self.name}: column {missing[0]} is missing and is needed{known}")
        return np.array([self.columns[name] for name in names]).T.reshape(len(self.time), len(names))
