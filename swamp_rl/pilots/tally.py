"""Success and return of the episodes that end while a batch of boats is trained in."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import Array


class Tally:
    """Statistics of the episodes of n boats that end."""

    def __init__(self, n: int) -> None:
        self._sums = np.zeros(n)
        self._returns: list[float] = []
        self._successes = 0

    def add(self, rewards: Array, dones: Array, infos: Sequence[Mapping[str, Any]]) -> None:
        """Add a step: rewards (n,), dones (n,) and infos with the `outcome` of those done."""
        self._sums += rewards
        for i in np.flatnonzero(dones).tolist():
            self._returns.append(float(self._sums[i]))
            self._successes += infos[i]["outcome"] == "success"
        self._sums[dones] = 0.0

    def means(self) -> dict[str, float]:
        """Return the number of `episodes` ended, share of `success` and mean `return`; empty if none."""
        ended = len(self._returns)
        if not ended:
            return {}
        return {
            "episodes": ended,
            "success": self._successes / ended,
            "return": float(np.mean(self._returns)),
        }
