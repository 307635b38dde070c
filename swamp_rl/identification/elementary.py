"""Paper 003's bounded least squares: mass and quadratic drag from elementary motions (eq. 6, 7)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.servo import inertia_of
from swamp_rl.identification.estimate import BLOCK, Estimate, blocks_of, with_intervals
from swamp_rl.identification.identifiability import doubts
from swamp_rl.identification.motion import Motion
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

WIDEST = 10.0  # times what is expected of the boat: the most that a parameter may be
SLOW = 0.05  # rad/s or m/s from which the boat moves along or about an axis
STILL = 0.15  # m/s up to which it keeps its place while it turns, or its course while it goes straight
LEAST_ROWS = 50
LEAST_CHANGE = 1e-6  # N or N m
NAMES = ("mass", "drag")
NEEDED = {
    "surge": "runs straight ahead with steps of thrust",
    "yaw": "turns on the spot with steps of thrust",
}


def expected(boat: Boat, speed: float = 0.7) -> dict[str, tuple[float, float]]:
    """Mass or inertia with the water's, and quadratic drag, of surge and of yaw as the boat file has them.

    Drag [N s2/m2] at `speed` [m/s] ahead, for the towing tank's is not quadratic; [N m s2] on the spot.
    """
    record, curves = parameters(boat)[0], tank(boat)
    tow = towing(record, curves)
    surge = -hull_forces(speed, 0.0, 0.0, record, curves, tow)[0] / speed**2
    yaw = -hull_forces(0.0, 0.0, 1.0, record, curves, tow)[2]
    inertia = inertia_of(boat)
    return {"surge": (float(inertia[0]), float(surge)), "yaw": (float(inertia[2]), float(yaw))}


def bounded(X: Array, y: Array, most: Array) -> Array:
    """Least squares with every parameter between 0 and `most` (p,)."""
    from scipy.optimize import lsq_linear

    return np.asarray(lsq_linear(X / np.ones_like(most), y, bounds=(np.zeros_like(most), most)).x)


def surge_motion(motion: Motion) -> Motion:
    """The rows in which the boat goes straight, ahead or astern."""
    u, v, r = motion.velocity.T
    straight = (np.abs(r) < SLOW) & (np.abs(v) < STILL) & (np.abs(motion.jets[:, 2]) < 0.5)
    return motion.rows(straight & (np.abs(u) >= SLOW))


def yaw_motion(motion: Motion) -> Motion:
    """The rows in which the boat turns on the spot."""
    u, v, r = motion.velocity.T
    return motion.rows((np.abs(u) < STILL) & (np.abs(v) < STILL) & (np.abs(r) >= SLOW))


def identify_surge(motion: Motion, boat: Boat) -> tuple[Estimate, Estimate]:
    """M_11 [kg] and D_11 [N s2/m2] in M_11 u' + D_11 u |u| = X (eq. 6), with intervals; UserError."""
    return _identify(surge_motion(motion), 0, boat, "surge", ("kg", "N s2/m2"))


def identify_yaw(motion: Motion, boat: Boat) -> tuple[Estimate, Estimate]:
    """M_66 [kg m2] and D_66 [N m s2] in M_66 r' + D_66 r |r| = N (eq. 7), with intervals; UserError."""
    return _identify(yaw_motion(motion), 2, boat, "yaw", ("kg m2", "N m s2"))


def lacking(motion: Motion, name: str) -> str | None:
    """What the runs lack for `surge` or `yaw` to be identified at all; None where nothing."""
    return _lacking(surge_motion(motion), 0) if name == "surge" else _lacking(yaw_motion(motion), 2)


def _lacking(motion: Motion, axis: int) -> str | None:
    count = len(motion.time)
    if count < LEAST_ROWS:
        return f"{count} rows of it, {LEAST_ROWS} are needed"
    if np.ptp(motion.jets[:, axis]) < LEAST_CHANGE:
        return f"the force is the same in all its {count} rows"
    return None


def surge_doubts(motion: Motion, found: Sequence[Estimate]) -> list[str | None]:
    """Why the rows do not determine M_11 and D_11 as found; None where they do."""
    return _doubts(surge_motion(motion), 0, found)


def yaw_doubts(motion: Motion, found: Sequence[Estimate]) -> list[str | None]:
    """Why the rows do not determine M_66 and D_66 as found; None where they do."""
    return _doubts(yaw_motion(motion), 2, found)


def regressors(motion: Motion, axis: int) -> Array:
    """(T, 2) acceleration and speed times its size along one axis."""
    speed = motion.velocity[:, axis]
    return np.column_stack([motion.derivative[:, axis], speed * np.abs(speed)])


def _doubts(motion: Motion, axis: int, found: Sequence[Estimate]) -> list[str | None]:
    return doubts(regressors(motion, axis), found, motion.lengths, NAMES)


def _identify(
    motion: Motion, axis: int, boat: Boat, name: str, units: tuple[str, str]
) -> tuple[Estimate, Estimate]:
    X, force = regressors(motion, axis), motion.jets[:, axis]
    wrong = _lacking(motion, axis)
    if wrong:
        raise UserError(f"no elementary {name} motion: {wrong}; record {NEEDED[name]}")
    most = WIDEST * np.array(expected(boat)[name])
    blocks = blocks_of(motion.lengths, max(1, round(BLOCK / motion.step)))
    found = with_intervals(X, force, blocks, lambda A, b: bounded(A, b, most), units)
    return found[0], found[1]
