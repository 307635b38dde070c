"""Stamps of telemetry in their order, where packets are late, doubled or damaged and clocks are set."""

FARTHEST = 10_000_000
"""Microseconds by which a stamp may be later than the last: a link is given up after fewer without one."""
AGREED = 10
"""Stamps in a row that follow one another and not the last, a second of telemetry: the clock was set."""


class Stamps:
    """Feed it the stamps [µs] of packets as they come."""

    def __init__(self) -> None:
        self.jumps = 0
        "How often the sender's clock was set."
        self._last: int | None = None
        self._shift = 0
        self._others: list[int] = []

    def follow(self, stamp: int) -> int | None:
        """The stamp on a time without jumps; None for one that is late, doubled, or alone with its time."""
        if self._last is None or 0 < stamp - self._last <= FARTHEST:
            self._last = stamp
            self._others.clear()
            return stamp + self._shift
        if self._others and stamp == self._others[-1]:
            return None
        if self._others and not 0 < stamp - self._others[-1] <= FARTHEST:
            self._others.clear()
        self._others.append(stamp)
        if len(self._others) < AGREED:
            return None
        first, second = self._others[:2]
        self._shift += self._last + (second - first) - first
        self.jumps += 1
        self._last = stamp
        self._others.clear()
        return stamp + self._shift
