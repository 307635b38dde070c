"""A test for a change of mean in the innovations of a filter, over windows of several lengths.

Without a fault the normalised innovations are white with variance one, and so is sum / sqrt(n) of n of them
(Basseville and Nikiforov 1993, ch. 2: the generalised likelihood ratio of a change of mean). A model that is
slightly wrong correlates them: each statistic is divided by its own slowly forgotten root mean square.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.monitor.options import DEFAULT, Options
from swamp_rl.physics.compile import compiled

Array = NDArray[np.float64]


@dataclass
class ChangeTest:
    """Statistics of the last innovations of C channels in steps of dt [s]."""

    dt: float
    options: Options = DEFAULT
    channels: int = 6
    count: int = 0
    square: Array = field(init=False)
    statistic: Array = field(init=False)

    def __post_init__(self) -> None:
        least = self.options.least_samples
        self.lengths = np.unique([max(least, round(window / self.dt)) for window in self.options.windows])
        self.recent = np.zeros((self.lengths[-1], self.channels))
        self.keep = np.exp(-self.dt / self.options.forget)
        self.square = np.ones((len(self.lengths), self.channels))
        self.statistic = np.zeros_like(self.square)

    def add(self, normalised: Array, usual: bool = True) -> None:
        """Take the normalised innovations (C,) of one step, NaN where nothing was measured; usual: they count
        in the root mean squares.
        """
        self.recent[self.count % len(self.recent)] = normalised
        self.count += 1
        of = self.options
        window_sums(self.recent, self.count, self.lengths, of.clip, of.least_samples, self.statistic)
        if not usual:
            return
        limited = np.minimum(self.statistic**2, self.options.threshold**2)
        self.square = np.maximum(self.keep * self.square + (1.0 - self.keep) * limited, 1.0)

    @property
    def exceeded(self) -> Array:
        """(C,) largest statistic of each channel over its threshold: above 1 there is a change."""
        relative = np.abs(self.statistic) / np.sqrt(self.square)
        return np.asarray(relative.max(axis=0) / self.options.threshold)

    def accept(self) -> None:
        """Take the last innovations for usual ones, and forget them."""
        self.square = np.maximum(self.square, self.statistic**2)
        self.clear()

    def clear(self) -> None:
        """Forget the last innovations, not the root mean squares."""
        self.count = 0
        self.statistic[:] = 0.0


@compiled
def window_sums(recent: Any, count: int, lengths: Any, clip: float, least: int, statistic: Any) -> None:
    """Sum / sqrt(n) of the last `lengths` (W,) of `count` rows, the newest at (count - 1) % N of `recent`
    (N, C), into `statistic` (W, C). A row counts as far as it is finite and not zero; it is
    clipped. A window has `least` rows or more.
    """
    for channel in range(recent.shape[1]):
        total, seen, window = 0.0, 0, 0
        for back in range(lengths[-1]):
            if back < count:
                value = recent[(count - 1 - back) % recent.shape[0], channel]
                if math.isfinite(value) and value != 0.0:
                    total += min(max(value, -clip), clip)
                    seen += 1
            if back + 1 == lengths[window]:
                statistic[window, channel] = total / math.sqrt(max(seen, least))
                window += 1
