"""A run as the analysis reads it: an unwrapped motion with its steering angle and its throttle."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.errors import UserError
from swamp_rl.guidance.heading import slowest_speed
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
    angles, forward, levels = [], [], []
    for thruster in boat.thrusters:
        angle_column, level_column = thruster.command_columns
        level = run.columns.get(level_column)
        if level is None:
            continue
        levels.append(level / thruster.throttle_max)
        angle = run.columns.get(angle_column or "")
        if angle is not None:
            angles.append((_side(thruster) * _about_zero(angle), np.abs(level) > 0.0))
            forward += angles[-1:] if thruster.x > 0.0 else []
    nothing = np.full(len(run.time), math.nan)
    if not levels:
        return nothing, nothing
    strongest = np.max(np.abs(levels), axis=0)
    # The forward thrusters tell the angle for each pattern; what does not push does not steer.
    ahead = forward or angles
    if not ahead:
        return nothing, strongest
    weight = np.array([works for _, works in ahead], float)
    total = np.maximum(weight.sum(axis=0), 1e-12)
    return (weight * np.array([angle for angle, _ in ahead])).sum(axis=0) / total, strongest


def _side(thruster: Thruster | PropellerRudder) -> float:
    return -1.0 if isinstance(thruster, Thruster) and thruster.x < 0.0 else 1.0


def _about_zero(angle: Array) -> Array:
    """An azimuth as the angle off the fore-and-aft line, whether the thruster pushes ahead or astern."""
    return np.arcsin(np.clip(np.sin(angle), -1.0, 1.0))
