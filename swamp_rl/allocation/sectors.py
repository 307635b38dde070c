"""Which way each jet may push: its azimuth range and reach, less forbidden sectors, in convex pieces."""

import math
from dataclasses import dataclass

from swamp_rl.allocation.jets import Jets

WIDEST = math.pi  # a sector up to half a turn is convex
WIDEST_WITH_LEAST = 0.5 * math.pi  # where a least thrust is asked: the straight limit inside loses little
EPSILON = 1e-9


@dataclass(frozen=True)
class Sector:
    """Azimuths from `low` to `high` [rad] in which jet k may push `least` to `most` [N].

    astern: it pushes against its azimuth. A sector of a whole turn has no edges.
    """

    k: int
    low: float
    high: float
    least: float
    most: float
    astern: bool = False

    @property
    def width(self) -> float:
        """rad."""
        return self.high - self.low

    @property
    def whole(self) -> bool:
        """Whether every direction is allowed."""
        return self.width >= math.tau - EPSILON

    def direction(self, azimuth: float, offset: float) -> float:
        """Direction of the force [rad] at an azimuth of this sector."""
        return azimuth + offset + (math.pi if self.astern else 0.0)


def sectors_of(jets: Jets, k: int, azimuth: float, reach: float) -> list[Sector]:
    """Convex sectors in which jet k may push, `reach` [rad] from its `azimuth` at most; none if failed."""
    if not jets.works[k]:
        return []
    low, high = float(jets.azimuth_min[k]), float(jets.azimuth_max[k])
    if math.isinf(reach) and high - low >= math.tau:
        low, high = -math.pi, math.pi  # any wanted direction is some azimuth within the range
    else:
        low, high = max(low, azimuth - reach), min(high, azimuth + reach)
    pieces = [(low, high)] if high >= low else []
    for start, end in jets.forbidden[k]:
        pieces = [rest for piece in pieces for rest in _less(piece, start, start + (end - start) % math.tau)]
    least = float(jets.thrust_min[k])
    widest = WIDEST if least == 0.0 else WIDEST_WITH_LEAST
    narrow = [part for piece in pieces for part in _split(*piece, widest, free=least == 0.0)]
    found = [Sector(k, a, b, least, float(jets.thrust_max[k])) for a, b in narrow]
    if jets.astern_max[k] > 0.0:
        found += [
            Sector(k, a, b, min(least, float(jets.astern_max[k])), float(jets.astern_max[k]), astern=True)
            for a, b in narrow
            if not (b - a >= math.tau - EPSILON and jets.astern_max[k] <= jets.thrust_max[k])
        ]
    return found


def _less(piece: tuple[float, float], start: float, end: float) -> list[tuple[float, float]]:
    """An interval less a forbidden one, which repeats every turn."""
    left = [piece]
    first = math.floor((piece[0] - end) / math.tau)
    for turn in range(first, first + math.ceil((piece[1] - piece[0]) / math.tau) + 3):
        a, b = start + turn * math.tau, end + turn * math.tau
        rest: list[tuple[float, float]] = []
        for low, high in left:
            if high <= a or low >= b:
                rest.append((low, high))
                continue
            if low < a:
                rest.append((low, a))
            if high > b:
                rest.append((b, high))
        left = rest
    return left


def _split(low: float, high: float, widest: float, free: bool) -> list[tuple[float, float]]:
    """Equal parts no wider than `widest`; a whole turn stays one where no least thrust is asked."""
    if free and high - low >= math.tau - EPSILON:
        return [(low, low + math.tau)]
    parts = max(1, math.ceil((high - low) / widest - EPSILON))
    step = (high - low) / parts
    return [(low + i * step, low + (i + 1) * step) for i in range(parts)]
