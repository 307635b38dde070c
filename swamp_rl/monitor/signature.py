"""Signatures: by how much an effect that begins at a step of the filter changes the innovations after it.

The difference of two simulations from the filter's state, with the effect and without, put through the
filter's own gains (Willsky and Jones 1976).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.monitor.tracker import CURRENT, Step, differences
from swamp_rl.navigation.predict import STATES
from swamp_rl.physics.compile import compiled
from swamp_rl.simulator import simulate, tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.state import TIME
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]


def signatures(boat: Boat, records: NDArray[Any], window: Sequence[Step], dt: float) -> Array:
    """(n - 1, N) change of the whitened innovations by each of the records (n,) against the first, from the
    first step of a window on. The current is the filter's there, and what a record has more of it.
    """
    params = records.copy()
    for name, value in zip(CURRENT, window[0].x[6:STATES], strict=True):
        params[name] += value - records[name][0]
    start = np.repeat(window[0].state[None], len(params), axis=0)
    commands = np.repeat(np.array([step.commands for step in window[:-1]])[None], len(params), axis=0)
    seeds = np.zeros(len(params), np.uint64)
    tracks = simulate(params, tank(boat), start, commands, seeds, dt, substeps_of(dt, boat))
    seen = observe(tracks, params, dt, start[:, TIME])
    return whitened(differences(seen[1:] - seen[0]), window)


def whitened(deviation: Array, window: Sequence[Step]) -> Array:
    """(n, N) innovations of the filter that a deviation (n, T, 6) of the measurements adds, whitened; six of
    each step after the first, zeros where nothing was measured.
    """
    jacobians = np.array([step.jacobian for step in window[1:]])
    gains = np.array([step.gain for step in window[1:]])
    whiteners = np.array([step.whitener for step in window[1:]])
    return np.asarray(filtered(deviation, jacobians, gains, whiteners))


def white_of(window: Sequence[Step]) -> Array:
    """(N,) whitened innovations of the steps after the first."""
    return np.concatenate([step.whitener @ step.innovation for step in window[1:]])


@compiled
def filtered(deviation: Any, jacobians: Any, gains: Any, whiteners: Any) -> Any:
    """`whitened`, of jacobians (T - 1, 8, 8), gains (T - 1, 8, 6) and whiteners (T - 1, 6, 6)."""
    count, steps, states = deviation.shape[0], jacobians.shape[0], jacobians.shape[1]
    out = np.empty((count, 6 * steps))
    moved, added = np.empty(states), np.empty(6)
    for i in range(count):
        estimate = np.zeros(states)
        for t in range(steps):
            for row in range(states):
                moved[row] = 0.0
                for k in range(states):
                    moved[row] += jacobians[t, row, k] * estimate[k]
            for row in range(6):
                added[row] = deviation[i, t + 1, row] - moved[row]
            for row in range(6):
                total = 0.0
                for k in range(row + 1):
                    total += whiteners[t, row, k] * added[k]
                out[i, 6 * t + row] = total
            for row in range(states):
                estimate[row] = moved[row]
                for k in range(6):
                    estimate[row] += gains[t, row, k] * added[k]
    return out
