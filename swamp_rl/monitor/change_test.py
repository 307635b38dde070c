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

from swamp_rl.physics.compile import compiled

Array = NDArray[np.float64]

WINDOWS = (0.3, 1.0, 3.0)  # s
CLIP = 5.0  # of a normalised innovation: beyond it is an outlier, of which one alone must not alarm
FORGET = 60.0  # s, of the root mean square of a statistic
LEAST_SAMPLES = 3  # of a window


@dataclass
class ChangeTest:
    """Statistics of the last innovations of C channels in steps of dt [s]; threshold: standard deviations."""

    dt: float
    threshold: float
    channels: int = 6
    count: int = 0
    square: Array = field(init=False)
    statistic: Array = field(init=False)

    def __post_init__(self) -> None:
        self.lengths = np.unique([max(LEAST_SAMPLES, round(window / self.dt)) for window in WINDOWS])
        self.recent = np.zeros((self.lengths[-1], self.channels))
        self.keep = np.exp(-self.dt / FORGET)
        self.square = np.ones((len(self.lengths), self.channels))
        self.statistic = np.zeros_like(self.square)

    def add(self, normalised: Array) -> None:
        """Take the normalised innovations (C,) of one step, NaN where nothing was measured."""
        self.recent[self.count % len(self.recent)] = normalised
        self.count += 1
        window_sums(self.recent, self.count, self.lengths, self.statistic)
        limited = np.minimum(self.statistic**2, self.threshold**2)
        self.square = np.maximum(self.keep * self.square + (1.0 - self.keep) * limited, 1.0)

    @property
    def exceeded(self) -> Array:
        """(C,) largest statistic of each channel over its threshold: above 1 there is a change."""
        relative = np.abs(self.statistic) / np.sqrt(self.square)
        return np.asarray(relative.max(axis=0) / self.threshold)

    def clear(self) -> None:
        """Forget the last innovations, not the root mean squares."""
        self.count = 0
        self.statistic[:] = 0.0


@compiled
def window_sums(recent: Any, count: int, lengths: Any, statistic: Any) -> None:
    """Sum / sqrt(n) of the last `lengths` (W,) of `count` rows, the newest at (count - 1) % N of `recent`
    (N, C), into `statistic` (W, C). A row counts as far as it is finite and not zero; it is clipped.
    """
    for channel in range(recent.shape[1]):
        total, seen, window = 0.0, 0, 0
        for back in range(lengths[-1]):
            if back < count:
                value = recent[(count - 1 - back) % recent.shape[0], channel]
                if math.isfinite(value) and value != 0.0:
                    total += min(max(value, -CLIP), CLIP)
                    seen += 1
            if back + 1 == lengths[window]:
                statistic[window, channel] = total / math.sqrt(max(seen, LEAST_SAMPLES))
                window += 1
