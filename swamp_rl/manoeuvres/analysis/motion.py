"""A run as the analysis reads it: an unwrapped motion with its steering angle and its throttle."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.errors import UserError
from swamp_rl.guidance.heading import slowest_speed
from swamp_rl.manoeuvres.steering import difference_angle
from swamp_rl.runs import Run

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """(T,) each: s, m, rad (heading unwrapped), m/s over ground, rad/s.

    angle [rad] and throttle [1]: of the steering as asked for, NaN where the run holds no commands; length of
    the boat [m].
    """

    time: Array
    north: Array
    east: Array
    heading: Array
    surge: Array
    sway: Array
    yaw_rate: Array
    angle: Array
    throttle: Array
    length: float

    @property
    def position(self) -> Array:
        """(T, 2) north, east [m]."""
        return np.stack([self.north, self.east], axis=1)

    def row(self, time: float) -> int:
        """The first row at or after `time` [s]."""
        return min(int(np.searchsorted(self.time, time - 1e-6)), len(self.time) - 1)

    def heading_before(self, row: int, seconds: float = 1.0) -> float:
        """Mean heading [rad] of the last second before a row: one noisy sample would be a poor origin."""
        first = self.row(self.time[row] - seconds)
        return float(self.heading[first : row + 1].mean())

    def speed_before(self, row: int, seconds: float = 3.0) -> float:
        """Speed over ground [m/s] over the last seconds before a row, by the way made."""
        first = self.row(self.time[row] - seconds)
        if first == row:
            return float(np.hypot(self.surge[row], self.sway[row]))
        made = self.position[row] - self.position[first]
        return float(np.hypot(*made) / (self.time[row] - self.time[first]))

    @property
    def pace(self) -> float:
        """Speed [m/s] below which nothing is made nondimensional."""
        return slowest_speed(self.length)


def motion_of(run: Run, boat: Boat) -> Motion:
    """The motion of a run; velocities that it does not hold are the differences of its track.

    UserError for a run of one row.
    """
    columns, time = run.columns, run.time
    if len(time) < 2:
        raise UserError(f"run {run.name}: has {len(time)} row(s); a manoeuvre has two or more")
    heading = np.unwrap(columns["heading"])
    north_rate, east_rate = np.gradient(columns["north"], time), np.gradient(columns["east"], time)
    surge, sway = turned(north_rate, east_rate, -heading)
    angle, throttle = steering_of(run, boat)
    return Motion(
        time,
        columns["north"],
        columns["east"],
        heading,
        columns.get("surge", surge),
        columns.get("sway", sway),
        columns.get("yaw_rate", np.gradient(heading, time)),
        angle,
        throttle,
        boat.length,
    )


def steering_of(run: Run, boat: Boat) -> tuple[Array, Array]:
    """Steering angle [rad], positive turning the bow to starboard, and throttle as a share of full [1]."""
    driven = [(t, run.columns[t.command_columns[1]]) for t in boat.thrusters if _driven(t, run)]
    nothing = np.full(len(run.time), math.nan)
    if not driven:
        return nothing, nothing
    strongest = np.max([_share(thruster, level) for thruster, level in driven], axis=0)
    angle = _turned_angle(run, driven)
    if angle is None:
        angle = difference_angle(driven)
    return nothing if angle is None else angle, strongest


def _driven(thruster: Thruster | PropellerRudder, run: Run) -> bool:
    return thruster.command_columns[1] in run.columns


def _share(thruster: Thruster | PropellerRudder, level: Array) -> Array:
    """Of full ahead, or of full astern where it pushes astern."""
    full = np.where(level < 0.0, -thruster.throttle_min, thruster.throttle_max)
    return np.abs(level) / np.where(full > 0.0, full, thruster.throttle_max)


def _turned_angle(run: Run, driven: Sequence[tuple[Thruster | PropellerRudder, Array]]) -> Array | None:
    """The angle by the azimuths and rudders of the thrusters with these commands, None without any."""
    angles, forward = [], []
    for thruster, level in driven:
        angle = run.columns.get(thruster.command_columns[0] or "")
        if angle is not None:
            angles.append((_side(thruster) * _about_zero(angle), np.abs(level) > 0.0))
            forward += angles[-1:] if thruster.x > 0.0 else []
    # The forward thrusters tell the angle for each pattern; what does not push does not steer.
    ahead = forward or angles
    if not ahead:
        return None
    weight = np.array([works for _, works in ahead], float)
    total = np.maximum(weight.sum(axis=0), 1e-12)
    return np.asarray((weight * np.array([angle for angle, _ in ahead])).sum(axis=0) / total, np.float64)


def _side(thruster: Thruster | PropellerRudder) -> float:
    return -1.0 if isinstance(thruster, Thruster) and thruster.x < 0.0 else 1.0


def _about_zero(angle: Array) -> Array:
    """An azimuth as the angle off the fore-and-aft line, whether the thruster pushes ahead or astern."""
    return np.arcsin(np.clip(np.sin(angle), -1.0, 1.0))
