"""What short pushes on the hull would do to every window: the response that missing forces are fitted by."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

STEP = 0.01  # m/s2 or rad/s2, of the finite difference
AXES = 3  # surge, sway, yaw


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
    columns = []
    for axis in axes:
        moved = np.repeat(acting[None], count, axis=0)
        moved[np.arange(count), :, np.arange(count), axis] += STEP
        track = problem.predict(
            hypothesis,
            np.repeat(x[None], count, axis=0),
            np.repeat(states[None], count, axis=0),
            moved.reshape(-1, count, AXES),
            pushes.block,
        )
        change = (track - base) / (STEP * pushes.inertia[axis])
        columns.append(problem.weighed(change.reshape(count, *base.shape)))
    stacked = np.stack(columns, axis=1)  # (B, axes, W, M)
    return np.moveaxis(stacked.reshape(-1, windows, stacked.shape[-1]), 0, -1)
