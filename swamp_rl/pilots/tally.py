"""How a batch of boats fares while a learner tries: episodes ended, how many well, and what they paid."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import Array


class Tally:
    """Counts the episodes of n boats that end; one under way at the beginning counts from there."""

    def __init__(self, n: int) -> None:
        self._paid = np.zeros(n)
        self._returns: list[float] = []
        self._successes = 0

    def add(self, rewards: Array, dones: Array, infos: Sequence[Mapping[str, Any]]) -> None:
        """A step: rewards (n,), dones (n,), and infos with the `outcome` of those done."""
        self._paid += rewards
        for i in np.flatnonzero(dones).tolist():
            self._returns.append(float(self._paid[i]))
            self._successes += infos[i]["outcome"] == "success"
        self._paid[dones] = 0.0

    def means(self) -> dict[str, float]:
        """`episodes` ended, and of these the share of `success` and the mean `return`; nothing of none."""
        ended = len(self._returns)
        if not ended:
            return {}
        return {
            "episodes": ended,
            "success": self._successes / ended,
            "return": float(np.mean(self._returns)),
        }
