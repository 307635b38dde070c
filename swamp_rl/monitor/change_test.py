"""A test for a change of mean in the innovations of a filter, over windows of several lengths.

Without a fault the normalised innovations are white with variance one, and so is sum / sqrt(n) of n of them
(Basseville and Nikiforov 1993, ch. 2: the generalised likelihood ratio of a change of mean). A model that is
slightly wrong correlates them: each statistic is divided by its own slowly forgotten root mean square.
"""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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
    recent: deque[Array] = field(default_factory=deque)
    square: Array = field(init=False)
    statistic: Array = field(init=False)

    def __post_init__(self) -> None:
        self.lengths = sorted({max(LEAST_SAMPLES, round(window / self.dt)) for window in WINDOWS})
        self.recent = deque(maxlen=self.lengths[-1])
        self.square = np.ones((len(self.lengths), self.channels))
        self.statistic = np.zeros_like(self.square)

    def add(self, normalised: Array) -> None:
        """Take the normalised innovations (C,) of one step, NaN where nothing was measured."""
        self.recent.append(np.clip(np.nan_to_num(normalised), -CLIP, CLIP))
        rows = np.array(self.recent)
        seen = np.cumsum(rows[::-1] != 0.0, axis=0)
        sums = np.cumsum(rows[::-1], axis=0)
        for place, length in enumerate(self.lengths):
            last = min(length, len(rows)) - 1
            self.statistic[place] = sums[last] / np.sqrt(np.maximum(seen[last], LEAST_SAMPLES))
        keep = np.exp(-self.dt / FORGET)
        limited = np.minimum(self.statistic**2, self.threshold**2)
        self.square = np.maximum(keep * self.square + (1.0 - keep) * limited, 1.0)

    @property
    def exceeded(self) -> Array:
        """(C,) largest statistic of each channel over its threshold: above 1 there is a change."""
        relative = np.abs(self.statistic) / np.sqrt(self.square)
        return np.asarray(relative.max(axis=0) / self.threshold)

    def clear(self) -> None:
        """Forget the last innovations, not the root mean squares."""
        self.recent.clear()
        self.statistic[:] = 0.0
