"""History of n boats: the observations and levers of the last decisions, as part of the observation."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.pilots.arrays import Array

LEVERS = 2


class Memory:
    """The last `depth` decisions of each boat.

    Wind, current or a weak thruster are not observed; they follow from the change between two observations
    under known levers. The history of a boat's first decision is its first observation with levers at zero.
    """

    def __init__(self, depth: int, width: int) -> None:
        """depth: decisions kept, at least 0; width: numbers of an observation, d."""
        self.depth, self.width = depth, width
        self.begin(0)

    @property
    def seen_width(self) -> int:
        """Width of an observation with its history: d + depth (d + 2)."""
        return self.width + self.depth * (self.width + LEVERS)

    def begin(self, n: int) -> None:
        """Set the number of boats to n, without history."""
        self._past = np.zeros((n, self.depth, self.width + LEVERS))
        self._blank = np.ones(n, dtype=bool)

    def forget(self, mask: Array) -> None:
        """Clear the history of the boats of `mask` (n,)."""
        self._blank |= np.asarray(mask, dtype=bool)

    def choose(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self._past, self._blank = self._past[boats], self._blank[boats]

    def recall(self, observation: Array, boats: Array | Sequence[int] | slice = slice(None)) -> Array:
        """Return (m, seen_width): observation (m, d) of the chosen boats and their history, latest first."""
        if not self.depth:
            return observation
        past = self._past[boats]
        blank = self._blank[boats]
        past[blank, :, : self.width] = observation[blank, None]
        past[blank, :, self.width :] = 0.0
        return np.concatenate([observation, past.reshape(len(observation), -1)], axis=1)

    def keep(
        self, observation: Array, levers: Array, boats: Array | Sequence[int] | slice = slice(None)
    ) -> None:
        """Append the observation (m, d) and the levers (m, 2) of the chosen boats to their history."""
        if not self.depth:
            return
        past = self.recall(observation, boats)[:, self.width :].reshape(-1, self.depth, self.width + LEVERS)
        latest = np.concatenate([observation, levers], axis=1)[:, None]
        self._past[boats] = np.concatenate([latest, past[:, :-1]], axis=1)
        self._blank[boats] = False
