"""A short memory of n boats: what each saw at its last decisions, and the levers it then chose."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.pilots.arrays import Array

LEVERS = 2


class Memory:
    """The last `depth` decisions of each boat, which tell a pilot of wind, current and a weak thruster.

    From the change between two observations under known levers follows what else acts on the boat. Before
    its first decision a boat has lain at its first observation with the levers at nought.
    """

    def __init__(self, depth: int, width: int) -> None:
        """depth: decisions kept, at least 0; width: numbers of an observation, d."""
        self.depth, self.width = depth, width
        self.begin(0)

    @property
    def seen_width(self) -> int:
        """Numbers of an observation together with the past: d + depth (d + 2)."""
        return self.width + self.depth * (self.width + LEVERS)

    def begin(self, n: int) -> None:
        """Begin with n boats that remember nothing."""
        self._past = np.zeros((n, self.depth, self.width + LEVERS))
        self._blank = np.ones(n, dtype=bool)

    def forget(self, mask: Array) -> None:
        """The boats of `mask` (n,) remember nothing."""
        self._blank |= np.asarray(mask, dtype=bool)

    def choose(self, boats: Array) -> None:
        """Go on with the boats of the places `boats` (m,) alone."""
        self._past, self._blank = self._past[boats], self._blank[boats]

    def recall(self, observation: Array, boats: Array | Sequence[int] | slice = slice(None)) -> Array:
        """Rows (m, seen_width): observation (m, d) of the boats chosen, then their past, latest first."""
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
        """Remember what the boats chosen saw (m, d) and the levers (m, 2) that they decided on."""
        if not self.depth:
            return
        past = self.recall(observation, boats)[:, self.width :].reshape(-1, self.depth, self.width + LEVERS)
        latest = np.concatenate([observation, levers], axis=1)[:, None]
        self._past[boats] = np.concatenate([latest, past[:, :-1]], axis=1)
        self._blank[boats] = False
