"""Terms of the user's own beside the compiled step: outside of it, and only where they are asked for."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.kernel import DIVERGED, OUTCOMES, RUNNING, sense_all, survey
from swamp_rl.envs.own_terms import Batch
from swamp_rl.envs.task import Task

from swamp_rl.course import gate_table
from swamp_rl.simulator.state import ACTUATORS, NORTH, SURGE, YAW_RATE

Array = NDArray[Any]
NAMES = np.array(OUTCOMES)


class OwnStep:
    """What n boats did in a step, as the terms of a task are given it, and what these make of it."""

    def __init__(self, task: Task, boats: Array, params: Array) -> None:
        """boats, params (n,): the records that the step changes."""
        self._task, self._boats, self._params = task, boats, params
        self._gates = gate_table(task.course)
        self.note()

    def note(self) -> None:
        """Keep how the boats are before the step, and which of them will be sailed."""
        self._to_go, _, _ = self._surveyed()
        self._passed, self._lever = self._boats["passed"].copy(), self._boats["lever"].copy()
        self._sailed = (self._boats["outcome"] == RUNNING) & ~self._boats["fresh"]

    def add(self, rewards: NDArray[np.float64], observations: NDArray[np.float32]) -> None:
        """Add to the rewards (n,) and fill the observations (n, d) of the step.

        A boat that was not sailed, or whose motion diverged, is paid nothing.
        """
        batch = self._batch(np.arange(len(self._boats)))
        paid = self._sailed & (self._boats["outcome"] != DIVERGED)
        for weight, term in self._task.own_rewards:
            rewards += np.where(paid, weight * term.of(batch), 0.0)
        for column, term in self._task.observed.own:
            observations[:, column] = term.of(batch)

    def look(self, chosen: NDArray[np.intp], observations: NDArray[np.float32]) -> None:
        """Fill the rows `chosen` (m,) of observations (n, d) of boats that have just started."""
        self.note()
        for column, term in self._task.observed.own:
            observations[chosen, column] = term.of(self._batch(chosen))

    def _surveyed(self) -> tuple[Array, Array, Array]:
        """Distance to go (n,), velocity of the air and of the current (n, 2)."""
        n = len(self._boats)
        to_go, wind, current = np.empty(n), np.empty((n, 2)), np.empty((n, 2))
        survey(self._boats, self._params, self._gates, to_go, wind, current)
        return to_go, wind, current

    def _batch(self, chosen: NDArray[np.intp]) -> Batch:
        """The boats `chosen` (m,), compared with what was noted."""
        boats, state, step = self._boats, self._boats["state"], self._task.step
        to_go, wind, current = self._surveyed()
        sensed = np.empty((len(boats), 3))
        sense_all(boats, self._params, step, sensed)
        return Batch(
            boat=self._task.boat,
            course=self._task.course,
            step=step,
            time=boats["tick"][chosen] * step,
            pose=state[chosen, NORTH : NORTH + 3],
            sensed_pose=sensed[chosen],
            velocity=state[chosen, SURGE : YAW_RATE + 1],
            action=boats["lever"][chosen],
            last_action=self._lever[chosen],
            commands=boats["command"][chosen],
            applied=state[chosen, ACTUATORS:],
            wind=wind[chosen],
            current=current[chosen],
            gates_passed=boats["passed"][chosen],
            gates_now=boats["passed"][chosen] - self._passed[chosen],
            way_made=self._to_go[chosen] - to_go[chosen],
            outcome=NAMES[boats["outcome"][chosen]],
        )
