"""Decisions that are held for several steps, counted for each boat from the start of its run."""

from collections.abc import Callable

import numpy as np

from swamp_rl.pilots.arrays import Array


class Held:
    """The levers of n boats, each decided every `steps` steps."""

    def __init__(self, steps: int) -> None:
        self.steps = steps
        self.begin(0)

    def __len__(self) -> int:
        return len(self._levers)

    def begin(self, n: int) -> None:
        """Set the number of boats to n; each decides at its next step."""
        self._held_for = np.zeros(n, dtype=np.int64)
        self._levers = np.zeros((n, 2))

    def forget(self, mask: Array) -> None:
        """Let the boats of `mask` (n,) decide at their next step."""
        self._held_for[np.asarray(mask, dtype=bool)] = 0

    def choose(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self._held_for, self._levers = self._held_for[boats], self._levers[boats]

    def step(self, decide: Callable[[Array], Array]) -> Array:
        """Levers (n, 2) of this step; `decide` gives those of the boats, by index (m,), that decide now."""
        due = np.flatnonzero(self._held_for == 0)
        if due.size:
            self._levers[due] = decide(due)
        self._held_for = (self._held_for + 1) % self.steps
        return self._levers.copy()
