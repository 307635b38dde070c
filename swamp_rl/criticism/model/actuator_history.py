"""Azimuths and throttles along runs from the commands, and from when on the start is irrelevant."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.boat import Boat
from swamp_rl.criticism.model.rollout import roll_actuators
from swamp_rl.criticism.options import options
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.substeps import steps_over

Array = NDArray[np.float64]

FIRST_ACTUATOR = ACTUATORS - 6  # of a row of `roll_actuators`, which begins with the time


def actuator_history(boat: Boat, commands: Array, dt: float, at_first_commands: bool = True) -> Array:
    """Azimuths [rad] and throttles [1] of the actuators (R, T, 2K) under the boat file.

    commands: (R, T, 2K), a row each dt [s]. The actuators are at their first commands at the start, or
    straight ahead and stopped.
    """
    records = parameters(boat, len(commands))
    return actuator_states(records, commands, commands.shape[1], dt, at_first_commands)[..., FIRST_ACTUATOR:]


def actuator_states(
    records: NDArray[Any],
    commands: Array,
    rows: int,
    dt: float,
    at_first_commands: bool = True,
    parts: int = 1,
) -> Array:
    """Time and actuators (R, rows, S - 6) of R boats with parameter records (R,); commands: (R, T parts, 2K),
    one for each of the equal parts of a row.
    """
    runs = len(commands)
    start = initial_state(records, np.zeros((runs, 3)))
    if at_first_commands:
        start[:, ACTUATORS:] = commands[:, 0]
    states = np.empty((runs, rows * parts, start.shape[1] - 6))
    roll_actuators(records, start, commands, np.arange(runs), dt / parts, states)
    return states[:, ::parts]


def first_compared(boat: Boat, commands: Array, lengths: NDArray[np.int64], dt: float) -> NDArray[np.int64]:
    """First row (R,) of each run that is compared with a simulation, at most in its middle.

    From there on the actuators' history is the same, whether they were straight ahead and stopped at the
    start or at their first commands.
    """
    apart = actuator_history(boat, commands, dt) - actuator_history(boat, commands, dt, False)
    differ = _differ(apart) & (np.arange(commands.shape[1]) < lengths[:, None])
    last = np.where(differ.any(axis=1), differ.shape[1] - np.argmax(differ[:, ::-1], axis=1), 0)
    return np.maximum(steps_over(options().least_transient, dt), np.minimum(last, lengths // 2))


def first_known_again(
    boat: Boat, commands: Array, lost: Sequence[tuple[int, int, int]], dt: float
) -> list[int]:
    """First row after each stretch of lost rows (run, row, rows) at which the actuators' history is the
    same, whether the commands (R, T, 2K) changed in its first row or after its last; T where there is none.
    """
    early, late = commands.copy(), commands.copy()
    for run, row, rows in lost:
        early[run, row : row + rows] = commands[run, min(row + rows, commands.shape[1] - 1)]
        late[run, row : row + rows] = commands[run, max(row - 1, 0)]
    differ = _differ(actuator_history(boat, early, dt) - actuator_history(boat, late, dt))
    differ = np.column_stack([differ, np.zeros(len(differ), bool)])
    return [row + rows + int(np.argmin(differ[run, row + rows :])) for run, row, rows in lost]


def _differ(apart: Array) -> NDArray[np.bool_]:
    """(R, T) whether two histories that are so far apart (R, T, 2K) differ, by the shorter way round."""
    azimuths = apart[..., : apart.shape[2] // 2]
    azimuths[:] = within_half_turn(azimuths)
    return np.asarray((np.abs(apart) > options().actuators_converged).any(axis=2))
