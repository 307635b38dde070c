"""One number of a boat file that a fit moves."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FARTHEST = 6.0  # prior widths to either side that a fit may move a number
# prior widths, of a finite difference; wide, since forces that jump, where a propeller's flow turns, make
# slopes over narrow ones meaningless
STEP = 3e-3


@dataclass(frozen=True)
class Number:
    """One number that a fit moves: `start` in the boat file, `sd` the standard deviation of its prior.

    name: its dotted key in the boat file, or `effects.` EFFECT.PARAMETER; field, thrusters, element: where it
    lands in the simulator's record. scaled: the fit moves x, by which the number is start · exp(x), and sd is
    of x; otherwise x is the number. low, high: of x. trial: the motion that shows it. least: where a fit
    begins at least, for a number without a gradient at its start.
    """

    name: str
    unit: str
    field: str
    start: float
    sd: float
    trial: str
    scaled: bool = False
    low: float = -math.inf
    high: float = math.inf
    thrusters: tuple[int, ...] | None = None
    element: int | None = None
    step: float = STEP
    least: float = -math.inf

    @property
    def mean(self) -> float:
        """Of the prior of x."""
        return 0.0 if self.scaled else self.start

    @property
    def begin(self) -> float:
        """Where a fit of x begins."""
        return max(self.mean, self.least)

    @property
    def bounds(self) -> tuple[float, float]:
        """Of x."""
        room = FARTHEST * self.sd
        return max(self.low, self.mean - room), min(self.high, self.mean + room)

    def value(self, x: float) -> float:
        """The number at x."""
        return self.start * math.exp(x) if self.scaled else x

    def spread(self, x: float, sd: float) -> float:
        """Standard deviation of the number, of that of x; `log_width` is the inverse."""
        if not self.scaled:
            return sd
        with np.errstate(over="ignore"):
            return abs(self.value(x)) * float(np.sqrt(np.exp(sd * sd) * np.expm1(sd * sd)))

    def write(self, record: NDArray[np.void], x: Array) -> None:
        """Put x (n,) into records (n,) of the start boat, in place."""
        field = record[self.field]
        if self.thrusters is None:
            field[:] = field * np.exp(x) if self.scaled else x
            return
        for k in self.thrusters:
            part = field[:, k] if self.element is None else field[:, k, self.element]
            column = x[:, None] if part.ndim == 2 else x
            part[:] = part * np.exp(column) if self.scaled else column


def log_width(ratio: float) -> float:
    """Standard deviation s of the logarithm of a number that is log-normal about its median, of the number's
    own standard deviation over the median: ratio² = e^{s²} (e^{s²} − 1)."""
    return math.sqrt(math.log1p(0.5 * (math.hypot(1.0, 2.0 * ratio) - 1.0)))
