"""A network that loses, delays, reorders and doubles datagrams, by a seeded generator and a given clock."""

import heapq
import itertools
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

Datagram = TypeVar("Datagram")


@dataclass(frozen=True)
class Faults:
    """Shares [1] of datagrams that are lost and doubled; delay: [s] least and greatest, drawn evenly for each
    copy, so that datagrams overtake each other where the spread is longer than the time between them."""

    loss: float = 0.0
    doubled: float = 0.0
    delay: tuple[float, float] = (0.0, 0.0)


PERFECT = Faults()


class Network(Generic[Datagram]):
    """Datagrams on their way."""

    def __init__(self, faults: Faults = PERFECT, seed: int = 0) -> None:
        self.faults = faults
        "May be changed under way."
        self._rng = np.random.default_rng(seed)
        self._numbers = itertools.count()
        self._under_way: list[tuple[float, int, Datagram]] = []

    def send(self, datagram: Datagram, now: float) -> None:
        """Take a datagram at the time `now` [s]."""
        if self._rng.random() < self.faults.loss:
            return
        for _ in range(1 + int(self._rng.random() < self.faults.doubled)):
            arrival = now + self._rng.uniform(*self.faults.delay)
            heapq.heappush(self._under_way, (arrival, next(self._numbers), datagram))

    def arrived(self, now: float) -> list[Datagram]:
        """Hand out the datagrams that have arrived by `now` [s], the earliest first."""
        found = []
        while self._under_way and self._under_way[0][0] <= now + 1e-9:
            found.append(heapq.heappop(self._under_way)[2])
        return found
