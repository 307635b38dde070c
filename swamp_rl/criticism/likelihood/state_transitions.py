"""State-transition matrices of windows: the response to any small force, without a simulation of each.

To first order the change d of a window's motion by an acceleration a follows from block to block of rows:

    d_{j} = S_j d_0 + R_j a        in row j of a block, d_0 at its start, a throughout it

S and R of all blocks come from six simulations with another state at their start and three with an
acceleration (variational equations, Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
section I.14).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import acceleration_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

STATES, AXES = 6, 3  # of the rigid motion; surge, sway and yaw


@dataclass(frozen=True)
class StateTransitions:
    """Motion (W, T, 6) of windows before their sensors, the start first, and of each of their L blocks of b
    rows the derivative of these by the state at its start and by accelerations [m/s2, m/s2, rad/s2] of surge,
    sway and yaw: matrices (W, L, 6 b, 9). Of a problem under a hypothesis with parameters x (p,).
    """

    problem: Shooting
    hypothesis: Hypothesis
    x: Array
    motion: Array
    matrices: Array

    @property
    def blocks(self) -> int:
        """L."""
        return self.matrices.shape[1]

    def responses(self, accelerations: Array) -> Array:
        """(W, T, 6, K) change of the motion by each of K accelerations (W or 1, L, 3, K)."""
        windows, blocks, entries, _ = self.matrices.shape
        rows, count = entries // STATES, accelerations.shape[3]
        change = np.zeros((windows, 1 + blocks * rows, STATES, count))
        acting = np.empty((windows, STATES + AXES, count))
        for b in range(blocks):
            acting[:, :STATES] = change[:, b * rows]
            acting[:, STATES:] = accelerations[:, b]
            block = change[:, b * rows + 1 : (b + 1) * rows + 1]
            np.matmul(self.matrices[:, b], acting, out=block.reshape(windows, entries, count))
        return change[:, : self.motion.shape[1]]

    def observed(self, change: Array) -> Array:
        """(K, W, T + 1, 6) small changes of what is measured by those of the motion (K, W, T, 6)."""
        if not self.problem.alters(self.hypothesis, self.x):
            return change
        steps = np.array(options().state_step) * self.problem.scale
        size = np.abs(change / steps).max(axis=(1, 2, 3), initial=0.0, keepdims=True)
        size = np.where(size > 0.0, size, 1.0)
        every = np.concatenate([self.motion[None], self.motion + change / size])
        seen = self.problem.observed(self.hypothesis, self.x, every)
        return np.asarray((seen[1:] - seen[0]) * size)


def state_transitions(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, acceleration: Array, rows: int
) -> StateTransitions:
    """About the motion from states (W, 6) under x (p,) and accelerations (W, B, 3), each for `rows` rows."""
    base = problem.motion(hypothesis, x[None], states[None], acceleration, rows)[0]
    blocks = -(-(base.shape[1] - 1) // rows)
    ahead = base.shape[1] - problem.windows.rows
    cut = problem.in_blocks(rows, blocks, ahead)
    acting = acceleration[:, np.minimum(np.arange(blocks), acceleration.shape[1] - 1)].reshape(-1, 1, AXES)
    started = base[:, : blocks * rows : rows].reshape(-1, STATES)
    step = np.concatenate(
        [
            np.array(options().state_step) * problem.scale,
            np.array(options().acceleration_step) * acceleration_scale(problem.boat),
        ]
    )
    variants = 1 + len(step)
    begun = np.repeat(started[None], variants, axis=0)
    pushed = np.repeat(acting[None], variants, axis=0)
    one, axis = np.arange(STATES), np.arange(AXES)
    begun[1 + one, :, one] += step[:STATES, None]
    pushed[1 + STATES + axis, :, 0, axis] += step[STATES:, None]
    same = np.repeat(x[None], variants, axis=0), begun, pushed.reshape(-1, 1, AXES)
    track = cut.motion(hypothesis, *same, rows)[:, :, 1 : rows + 1]
    slopes = (track[1:] - track[0]) / step[:, None, None, None]
    matrices = np.moveaxis(slopes, 0, -1).reshape(len(base), blocks, rows * STATES, len(step))
    return StateTransitions(problem, hypothesis, x, base, np.ascontiguousarray(matrices))
