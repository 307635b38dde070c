"""Sensitivity of every window to short forces on the hull, by which missing forces are estimated."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.fit import Normal, normal_equations
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

STEP = 0.01  # m/s2 or rad/s2, of the finite difference
AXES = 3  # surge, sway, yaw
CHUNK = 2**26  # bytes of slopes or tracks that are computed at once


@dataclass(frozen=True)
class Pushes:
    """Pieces of `block` steps that windows are divided into, B of them.

    inertia: (3,) mass with added mass [kg] of surge and sway, inertia of yaw [kg m2].
    """

    block: int
    count: int
    inertia: Array


def pushes_of(problem: Shooting, seconds: float) -> Pushes:
    """Pieces of about `seconds` for the windows of a comparison."""
    steps = problem.windows.rows - 1
    count = max(1, round(steps * problem.dt / seconds))
    return Pushes(-(-steps // count), count, inertia(problem.boat))


def inertia(boat: Boat) -> Array:
    """(3,) what surge and sway force and yaw moment accelerate; a centre of gravity off midship, which would
    couple sway with yaw, is left out.
    """
    record = parameters(boat)[0]
    return np.array(
        [
            record["mass"] - record["added_mass_surge"],
            record["mass"] - record["added_mass_sway"],
            record["inertia_z"] - record["added_inertia_yaw"],
        ]
    )


def push_normal(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    pushes: Pushes,
    axes: tuple[int, ...],
    by_state: Array,
    residual: Array,
    forces: Array | None = None,
    beside: Array | None = None,
    damping: Array | None = None,
) -> Normal:
    """Normal equations of a force [N, N m] along each axis in each piece, in bounded memory.

    by_state: (W, M, 6); residual: (W, M); forces (W, B, 3) that act already; beside (W, M, p): slopes by
    other parameters, whose columns come first; damping: (W,) of the initial states.
    """
    windows = problem.windows.count
    size = pushes.count * len(axes) * residual.shape[1] * residual.itemsize
    together = max(1, CHUNK // max(1, size))
    parts = []
    for start in range(0, windows, together):
        rows = slice(start, start + together)
        chosen = np.zeros(windows, dtype=bool)
        chosen[rows] = True
        part = problem if together >= windows else problem.part(chosen)
        acting = None if forces is None else forces[rows]
        slopes = push_slopes(part, hypothesis, x, states[rows], pushes, axes, acting)
        if beside is not None and beside.shape[2]:
            slopes = np.concatenate([beside[rows], slopes], axis=2)
        damped = 0.0 if damping is None else damping[rows, None]
        parts.append(normal_equations(by_state[rows], slopes, residual[rows], damped))
    return Normal(
        *(np.concatenate(field) for field in zip(*(vars(one).values() for one in parts), strict=True))
    )


def push_slopes(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    pushes: Pushes,
    axes: tuple[int, ...],
    forces: Array | None = None,
) -> Array:
    """(W, M, B len(axes)) change of the weighted prediction by a force of 1 N (or 1 N m) along each axis in
    each piece, piece by piece; about forces (W, B, 3) that act already.
    """
    windows, count = problem.windows.count, pushes.count
    acting = np.zeros((windows, count, AXES)) if forces is None else forces / pushes.inertia
    base = problem.predict(hypothesis, x[None], states[None], acting, pushes.block)[0]
    slopes = np.empty((count, len(axes), windows, base[0].size))
    together = max(1, CHUNK // base.nbytes)
    for (column, axis), start in itertools.product(enumerate(axes), range(0, count, together)):
        pieces = np.arange(start, min(start + together, count))
        variants = len(pieces)
        moved = np.repeat(acting[None], variants, axis=0)
        moved[np.arange(variants), :, pieces, axis] += STEP
        track = problem.predict(
            hypothesis,
            np.repeat(x[None], variants, axis=0),
            np.repeat(states[None], variants, axis=0),
            moved.reshape(-1, count, AXES),
            pushes.block,
        )
        track -= base
        track /= STEP * pushes.inertia[axis]
        slopes[pieces, column] = problem.weighed(track)
    return np.moveaxis(slopes.reshape(-1, windows, slopes.shape[-1]), 0, -1)
