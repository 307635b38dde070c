"""Paper 003's identification from a waypoint square: each axis by its elementary motions, then a replay."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.identification.elementary import LEAST_ROWS, NAMES, SLOW, WIDEST, bounded
from swamp_rl.identification.estimate import BLOCK, Estimate, blocks_of, with_intervals
from swamp_rl.identification.identifiability import doubts
from swamp_rl.identification.square_twin import STEP, Log, Vehicle, lift_at, moved

Array = NDArray[np.float64]

AXES = ("surge", "heave", "yaw")
UNITS = (("kg", "N s2/m2"), ("kg", "N s2/m2"), ("kg m2", "N m s2"))
SPAN, ORDER = 11, 2  # rows and order of the polynomial that velocities are differentiated by
NEEDED = {
    "surge": "sides on which the vehicle gathers speed",
    "heave": "a dive (depth above 0)",
    "yaw": "corners turned on the spot",
}


@dataclass(frozen=True)
class Found:
    """An axis: its mass and drag, and why the log does not show each; both None where it has no motion."""

    axis: str
    estimates: tuple[Estimate, Estimate] | None
    doubts: Sequence[str | None]

    @property
    def shown(self) -> bool:
        """Whether the log shows both."""
        return self.estimates is not None and not any(self.doubts)


def identify(vehicle: Vehicle, log: Log) -> list[Found]:
    """Mass and quadratic drag of surge, heave and yaw with 95 % intervals, in M v' + D v |v| + g = F.

    By least squares with bounds of `WIDEST` times the file's values. The surplus buoyancy g_3 is known.
    """
    return [_identified(vehicle, log, axis) for axis in range(3)]


def _identified(vehicle: Vehicle, log: Log, axis: int) -> Found:
    from scipy.signal import savgol_filter

    rows = (log.motion == axis) & (np.abs(log.velocity[:, axis]) >= SLOW)
    count = int(rows.sum())
    if count < LEAST_ROWS:
        why = f"no elementary {AXES[axis]} motion: {count} rows of it, {LEAST_ROWS} are needed"
        return Found(AXES[axis], None, (why, why))
    speed = savgol_filter(log.velocity[:, axis], SPAN, ORDER)
    rate = savgol_filter(log.velocity[:, axis], SPAN, ORDER, deriv=1, delta=STEP)
    lift = np.array([lift_at(vehicle, pose) for pose in log.pose]) if axis == 1 else 0.0
    held = log.force[:, axis] - lift
    held[1:] = 0.5 * (held[1:] + held[:-1])  # a row's force is held until the next row
    force = savgol_filter(held, SPAN, ORDER)
    X = np.column_stack([rate, speed * np.abs(speed)])[rows]
    most = WIDEST * np.array([vehicle.masses[axis], vehicle.drags[axis]])
    lengths = [count]
    blocks = blocks_of(lengths, round(BLOCK / STEP))
    found = with_intervals(X, force[rows], blocks, lambda A, b: bounded(A, b, most), UNITS[axis])
    return Found(AXES[axis], (found[0], found[1]), doubts(X, found, lengths, NAMES))


def replay(vehicle: Vehicle, log: Log, found: Sequence[Found]) -> Array:
    """(T, 4) poses that the identified vehicle takes under the logged forces from the first pose, in still
    water; an axis that the log does not show keeps the file's numbers."""
    masses, drags = vehicle.masses, vehicle.drags
    for axis, one in enumerate(found):
        if one.shown and one.estimates is not None:
            masses[axis], drags[axis] = one.estimates[0].value, one.estimates[1].value
    pose, velocity, poses = log.pose[0].copy(), np.zeros(3), []
    for force in log.force:
        poses.append(pose.copy())
        moved(pose, velocity, force, masses, drags, lift_at(vehicle, pose))
    return np.array(poses)


def track_error(log: Log, poses: Array) -> Array:
    """(T,) distance [m] between the true and the replayed place at the same time."""
    return np.asarray(np.sqrt(((poses[:, :3] - log.pose[:, :3]) ** 2).sum(axis=1)))
