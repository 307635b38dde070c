"""Paper 003's bounded least squares: mass and quadratic drag from elementary motions (eq. 6, 7)."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.servo import inertia_of
from swamp_rl.identification.estimate import BLOCK, Estimate, blocks_of, with_intervals
from swamp_rl.identification.motion import Motion
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

WIDEST = 10.0  # times what is expected of the boat: the most that a parameter may be
SLOW, STILL = 0.05, 0.15  # rad/s and m/s below which a motion does not count
LEAST_ROWS = 50


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
    _, v, r = motion.velocity.T
    return motion.rows((np.abs(r) < SLOW) & (np.abs(v) < STILL) & (np.abs(motion.jets[:, 2]) < 0.5))


def yaw_motion(motion: Motion) -> Motion:
    """The rows in which the boat turns on the spot."""
    u, v, _ = motion.velocity.T
    return motion.rows((np.abs(u) < STILL) & (np.abs(v) < STILL))


def identify_surge(motion: Motion, boat: Boat) -> tuple[Estimate, Estimate]:
    """M_11 [kg] and D_11 [N s2/m2] in M_11 u' + D_11 u |u| = X (eq. 6), with intervals; UserError."""
    return _identify(surge_motion(motion), 0, boat, "surge", ("kg", "N s2/m2"))


def identify_yaw(motion: Motion, boat: Boat) -> tuple[Estimate, Estimate]:
    """M_66 [kg m2] and D_66 [N m s2] in M_66 r' + D_66 r |r| = N (eq. 7), with intervals; UserError."""
    return _identify(yaw_motion(motion), 2, boat, "yaw", ("kg m2", "N m s2"))


def _identify(
    motion: Motion, axis: int, boat: Boat, name: str, units: tuple[str, str]
) -> tuple[Estimate, Estimate]:
    speed, rate, force = motion.velocity[:, axis], motion.derivative[:, axis], motion.jets[:, axis]
    if len(speed) < LEAST_ROWS or np.ptp(force) < 1e-6:
        needs = (
            "runs straight ahead with steps of thrust"
            if axis == 0
            else "turns on the spot with steps of thrust"
        )
        raise UserError(
            f"no elementary {name} motion: {len(speed)} rows with a force that changes; record {needs}"
        )
    most = WIDEST * np.array(expected(boat)[name])
    X = np.column_stack([rate, speed * np.abs(speed)])
    blocks = blocks_of(motion.lengths, max(1, round(BLOCK / motion.step)))
    found = with_intervals(X, force, blocks, lambda A, b: bounded(A, b, most), units)
    return found[0], found[1]
