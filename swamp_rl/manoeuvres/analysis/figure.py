"""A figure of a trial with its spread and its interval, and the block bootstrap behind it."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

RESAMPLES = 1000
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Figure:
    """One figure of a trial.

    each: its values turn by turn, execute by execute or block by block, mean and sd over those; low, high:
    ends of the 95 % bootstrap interval of `value`, NaN where there is nothing to resample.
    """

    value: float
    unit: str
    each: tuple[float, ...] = ()
    low: float = math.nan
    high: float = math.nan

    @property
    def mean(self) -> float:
        """Over `each`, the value itself where there is none."""
        return float(np.mean(self.each)) if self.each else self.value

    @property
    def sd(self) -> float:
        """Standard deviation over `each`, NaN for fewer than two."""
        return float(np.std(self.each, ddof=1)) if len(self.each) > 1 else math.nan

    def as_json(self) -> dict[str, Any]:
        """Plain values, None in place of NaN."""
        numbers = {"value": self.value, "mean": self.mean, "sd": self.sd, "low": self.low, "high": self.high}
        plain: dict[str, Any] = {name: plain_number(number) for name, number in numbers.items()}
        return plain | {"unit": self.unit, "each": [plain_number(number) for number in self.each]}


def plain_number(number: float) -> float | None:
    """The number, or None where JSON could not hold it."""
    return float(number) if math.isfinite(number) else None


@dataclass
class Result:
    """What one run showed: figures as they are and, for circles, with the drift removed; verdicts and notes.

    traces: arrays for the pictures; verdicts: sentences such as `course-unstable`; criteria: see `imo`.
    """

    run: str
    kind: str
    setting: dict[str, Any]
    figures: dict[str, Figure] = field(default_factory=dict)
    corrected: dict[str, Figure] = field(default_factory=dict)
    verdicts: dict[str, str] = field(default_factory=dict)
    criteria: list[Any] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    traces: dict[str, Array] = field(default_factory=dict)

    @property
    def best(self) -> dict[str, Figure]:
        """The figures to judge by: corrected where there are any."""
        return self.corrected or self.figures


def resampled_blocks(count: int, block: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """(RESAMPLES, count) indices of moving blocks of that length, drawn with replacement (Kuensch 1989)."""
    block = min(block, count)
    starts = rng.integers(0, count - block + 1, (RESAMPLES, -(-count // block)))
    return (starts[:, :, None] + np.arange(block)).reshape(RESAMPLES, -1)[:, :count]


def interval(values: ArrayLike) -> tuple[float, float]:
    """The ends of the interval that resampled values (RESAMPLES,) give."""
    finite = np.asarray(values, float)
    finite = finite[np.isfinite(finite)]
    if len(finite) == 0:
        return math.nan, math.nan
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(finite, (tail, 1.0 - tail))
    return float(low), float(high)


def over(each: ArrayLike, unit: str, rng: np.random.Generator) -> Figure:
    """The mean of several values, resampled one by one; those that are NaN are left out."""
    values = np.asarray(each, float)
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return Figure(math.nan, unit)
    low = high = math.nan
    if len(values) > 1:
        low, high = interval(values[resampled_blocks(len(values), 1, rng)].mean(axis=1))
    return Figure(float(values.mean()), unit, tuple(values.tolist()), low, high)


def over_blocks(series: Array, blocks: int, unit: str, rng: np.random.Generator) -> Figure:
    """The mean of a series, by the means of so many consecutive blocks of it."""
    parts = np.array_split(np.asarray(series, float), min(blocks, len(series)))
    return over([part.mean() for part in parts], unit, rng)
