"""Sensitivity of every window to short forces on the hull."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import Normal, normal_equations
from swamp_rl.criticism.likelihood.state_transitions import AXES, StateTransitions, state_transitions
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ForceGrid:
    """B intervals of `block` steps in which forces are constant.

    inertia: (3,) mass with added mass [kg] of surge and sway, inertia of yaw [kg m2].
    """

    block: int
    count: int
    inertia: Array


def force_grid(problem: Shooting, seconds: float) -> ForceGrid:
    """Intervals of about `seconds` for the windows of a problem."""
    steps = problem.windows.rows - 1
    count = max(1, round(steps * problem.dt / seconds))
    return ForceGrid(-(-steps // count), count, inertia(problem.boat))


def inertia(boat: Boat) -> Array:
    """(3,) inertia to surge and sway force and yaw moment; the coupling of sway and yaw is neglected."""
    record = parameters(boat)[0]
    return np.array(
        [
            record["mass"] - record["added_mass_surge"],
            record["mass"] - record["added_mass_sway"],
            record["inertia_z"] - record["added_inertia_yaw"],
        ]
    )


def inverse_correlation(pieces: int, piece: float, correlation_time: float) -> Array:
    """(B, B) inverse of the correlation of a Gauss-Markov process in B intervals of `piece` s."""
    apart = np.abs(np.subtract.outer(np.arange(pieces), np.arange(pieces))) * piece
    return np.linalg.inv(np.exp(-apart / correlation_time))


def force_normal_equations(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    grid: ForceGrid,
    axes: tuple[int, ...],
    by_state: Array,
    residual: Array,
    forces: Array | None = None,
    beside: Array | None = None,
) -> Normal:
    """Normal equations of a force [N, N m] along each axis in each interval, in bounded memory.

    by_state: (W, M, 6); residual: (W, M); forces: (W, B, 3) about which is linearised; beside: (W, M, p)
    Jacobian by other parameters, whose columns come first.
    """
    windows = problem.windows.count
    size = grid.count * len(axes) * residual.shape[1] * residual.itemsize
    together = max(1, options().chunk_bytes // max(1, size))
    parts = []
    for start in range(0, windows, together):
        rows = slice(start, start + together)
        chosen = np.zeros(windows, dtype=bool)
        chosen[rows] = True
        part = problem if together >= windows else problem.part(chosen)
        acting = None if forces is None else forces[rows]
        slopes = force_jacobian(part, hypothesis, x, states[rows], grid, axes, acting)
        if beside is not None and beside.shape[2]:
            slopes = np.concatenate([beside[rows], slopes], axis=2)
        parts.append(normal_equations(by_state[rows], slopes, residual[rows]))
    return Normal(
        *(np.concatenate(field) for field in zip(*(vars(one).values() for one in parts), strict=True))
    )


def force_jacobian(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    grid: ForceGrid,
    axes: tuple[int, ...],
    forces: Array | None = None,
) -> Array:
    """(W, M, B len(axes)) derivative of the standardised prediction by a force of 1 N (or 1 N m) along each
    axis in each interval, interval by interval; about forces (W, B, 3).
    """
    made = transitions(problem, hypothesis, x, states, grid, forces)
    pulses = np.zeros((made.blocks, AXES, grid.count, len(axes)))
    blocks = np.arange(made.blocks)
    for column, axis in enumerate(axes):
        pulses[blocks, axis, np.minimum(blocks, grid.count - 1), column] = 1.0
    pulses = pulses.reshape(1, made.blocks, AXES, -1)
    return force_responses(made, grid, pulses)


def transitions(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    grid: ForceGrid,
    forces: Array | None = None,
) -> StateTransitions:
    """State transitions in the grid's intervals, about forces (W, B, 3)."""
    still = np.zeros((problem.windows.count, grid.count, AXES))
    return state_transitions(
        problem, hypothesis, x, states, still if forces is None else forces / grid.inertia, grid.block
    )


def force_responses(made: StateTransitions, grid: ForceGrid, forces: Array) -> Array:
    """(W, M, K) derivative of the standardised prediction by the sizes of forces (W or 1, L, 3, K)."""
    change = np.moveaxis(made.responses(forces / grid.inertia[:, None]), -1, 0)
    return np.moveaxis(made.problem.standardised(made.observed(change)), 0, -1)
