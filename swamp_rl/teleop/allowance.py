"""A limit on how often something may happen."""


class Allowance:
    """How much is still allowed: it refills steadily, up to a burst."""

    def __init__(self, rate: float, burst: float) -> None:
        """rate: allowed a second."""
        self.rate, self.burst = rate, burst
        self._left, self._last = burst, 0.0

    def spend(self, now: float, amount: float = 1.0) -> bool:
        """Whether so much more is allowed at `now` [s]; it then counts."""
        self._left = min(self.burst, self._left + (now - self._last) * self.rate)
        self._last = now
        if self._left < amount:
            return False
        self._left -= amount
        return True
