"""What a regression needs of a run: velocities, derivatives, the jets' forces and the steering angle."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, Thruster
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.steering import difference_angle
from swamp_rl.physics.thrusters import jet_force
from swamp_rl.runs import Run
from swamp_rl.simulator import parameters
from swamp_rl.simulator.replay import VELOCITIES, fixed_thrusters, sample_step

Array = NDArray[np.float64]

PUSHES = 0.02  # throttle [1] from which a thruster counts as pushing


class Motion(NamedTuple):
    """Rows of one run. velocity, derivative: (T, 3) of surge, sway, yaw rate; jets: (T, 3) their forces.

    steering: (T,) azimuth [rad] that bow jets have and stern jets have opposite (002, section 3), of a boat
    of fixed thrusters the angle that a trial orders as their difference; throttle: (T,) mean of the jets
    that push [1]; lengths: rows of each run in it.
    """

    time: Array
    velocity: Array
    derivative: Array
    jets: Array
    steering: Array
    throttle: Array
    lengths: tuple[int, ...]

    @property
    def step(self) -> float:
        """s between rows."""
        return float(np.median(np.diff(self.time)))

    def rows(self, mask: NDArray[np.bool_]) -> "Motion":
        """The rows of `mask` (T,) alone."""
        ends = np.cumsum((0, *self.lengths))
        lengths = tuple(int(mask[a:b].sum()) for a, b in pairwise(ends))
        return Motion._make([*(column[mask] for column in self[:-1]), lengths])


def motion_of(run: Run, boat: Boat, smooth: float = 0.0) -> Motion:
    """A run of this boat, differentiated; UserError where velocities or commands are missing.

    smooth: span [s] of a quadratic smoother (Savitzky and Golay); 0 takes plain central differences.
    """
    dt = sample_step(run)
    velocity = run.stacked(VELOCITIES)
    derivative = np.gradient(velocity, run.time, axis=0)
    if smooth > 0.0:
        from scipy.signal import savgol_filter

        rows = 2 * max(2, round(smooth / dt / 2)) + 1
        if rows > len(velocity):
            raise UserError(
                f"run {run.name}: {run.duration:.3g} s is shorter than the smoothing of {smooth:g} s"
            )
        derivative = savgol_filter(velocity, rows, 2, deriv=1, delta=dt, axis=0)
        velocity = savgol_filter(velocity, rows, 2, axis=0)
    azimuth, throttle = np.split(_actuators(run, boat), 2, axis=1)
    jets = jet_forces(boat, azimuth, throttle)
    pushes = throttle > PUSHES
    count = np.maximum(pushes.sum(axis=1), 1)
    level = np.where(pushes, throttle, 0.0).sum(axis=1) / count
    angle = _steering(boat, azimuth, throttle, pushes)
    return Motion(run.time, velocity, derivative, jets, angle, level, (len(run.time),))


def _steering(boat: Boat, azimuth: Array, throttle: Array, pushes: NDArray[np.bool_]) -> Array:
    """(T,) the mean angle of the jets (T, K) that push; by their difference where none of them turns."""
    if all(thruster.kind == "fixed" for thruster in boat.thrusters):
        found = difference_angle(zip(boat.thrusters, throttle.T, strict=True))
        return np.zeros(len(throttle)) if found is None else found
    bow = np.sign([thruster.x for thruster in boat.thrusters])
    turned = (np.where(pushes, azimuth, 0.0) * bow).sum(axis=1)
    return np.asarray(turned / np.maximum(pushes.sum(axis=1), 1), np.float64)


def motions_of(runs: Sequence[Run], boat: Boat, smooth: float = 0.0) -> Motion:
    """Several runs, one after another."""
    each = [motion_of(run, boat, smooth) for run in runs]
    columns = [np.concatenate(parts) for parts in zip(*(one[:-1] for one in each), strict=True)]
    return Motion._make([*columns, tuple(one.lengths[0] for one in each)])


def _actuators(run: Run, boat: Boat) -> Array:
    """(T, 2K) azimuths and throttles as applied where that was recorded, else as commanded."""
    for thruster in boat.thrusters:
        if not isinstance(thruster, Thruster):
            raise UserError(
                f"boat {boat.name}: thrusters.{thruster.name} is not a jet; these methods are for jets"
            )
    found = run.commands(boat.thruster_names, fixed_thrusters(boat))
    for k, thruster in enumerate(boat.thrusters):
        for column, index in zip(thruster.command_columns, (k, len(boat.thrusters) + k), strict=True):
            applied = run.columns.get(f"applied_{column}")
            found[:, index] = found[:, index] if applied is None else applied
    return found


def jet_forces(boat: Boat, azimuth: Array, throttle: Array) -> Array:
    """(T, 3) surge, sway force [N] and yaw moment [N m] of the jets, thrust deduction included."""
    record = parameters(boat)[0]
    found = np.zeros((len(azimuth), 3))
    seen: dict[tuple[float, ...], tuple[float, float, float]] = {}
    for row in range(len(azimuth)):
        key = (*azimuth[row], *throttle[row])
        if key not in seen:
            surge = sway = yaw = 0.0
            for k, thruster in enumerate(boat.thrusters):
                x, y = jet_force(float(azimuth[row, k]), float(throttle[row, k]), k, record)
                surge, sway, yaw = surge + x, sway + y, yaw + thruster.x * y - thruster.y * x
            seen[key] = (surge, sway, yaw)
        found[row] = seen[key]
    return found
