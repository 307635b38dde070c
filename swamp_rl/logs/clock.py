"""The offset between two clocks, from one quantity that both record."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError

Array = NDArray[np.float64]

Record = tuple[Array, Array]
"""Times [s] and values."""
LONGEST_OFFSET = 10.0
"""s, to either side."""
LOWEST_CORRELATION = 0.5
"""Below it a quarter of the variance is common to both: they may be two quantities."""
FEWEST = 50
"""Points of the finer record that both must cover."""


@dataclass(frozen=True)
class Offset:
    """`seconds` to add to the second clock's times; `correlation` of the two records then."""

    seconds: float
    correlation: float


def clock_offset(one: Record, other: Record, where: str) -> Offset:
    """The shift of the other record (T_b,) that gives it the greatest correlation with the one (T_a,).

    Both are interpolated to the finer of their steps; between shifts the correlation is taken as a parabola.
    UserError where they overlap too little, do not vary, or where the correlation stays below
    LOWEST_CORRELATION.
    """
    (time_a, a), (time_b, b) = _in_order(one), _in_order(other)
    if min(len(time_a), len(time_b)) < 2:
        raise UserError(
            f"{where}: one of them has {min(len(time_a), len(time_b))} values; give another quantity"
        )
    step = min(float(np.median(np.diff(time))) for time in (time_a, time_b))
    low, high = max(time_a[0], time_b[0]), min(time_a[-1], time_b[-1])
    count = int((high - low) / step) if step > 0.0 else 0
    most = min(int(LONGEST_OFFSET / step), count // 3) if step > 0.0 else 0
    if count < FEWEST or most < 1:
        raise UserError(f"{where}: the two tables have {count} rows in common; the offset needs {FEWEST}")
    grid = low + step * np.arange(count)
    first, second = np.interp(grid, time_a, a), np.interp(grid, time_b, b)
    shifts = np.arange(-most, most + 1)
    found = np.array([_correlation(first, second, int(shift)) for shift in shifts])
    best = int(np.argmax(found))
    if not found[best] >= LOWEST_CORRELATION:
        raise UserError(
            f"{where}: correlation {found[best]:.2f} at best within {LONGEST_OFFSET:g} s; "
            "give one quantity that both record, with its sign"
        )
    part = 0.0
    if 0 < best < len(found) - 1:
        left, top, right = found[best - 1 : best + 2]
        bend = left - 2.0 * top + right
        part = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    return Offset(float((shifts[best] + part) * step), float(found[best]))


def _in_order(record: Record) -> Record:
    """A record by increasing times; messages may come late."""
    time, values = record
    order = np.argsort(time, kind="stable")
    return time[order], values[order]


def _correlation(first: Array, second: Array, shift: int) -> float:
    """Of first(t) with second(t − shift), in rows."""
    if shift >= 0:
        first, second = first[shift:], second[: len(second) - shift]
    else:
        first, second = first[:shift], second[-shift:]
    first, second = first - first.mean(), second - second.mean()
    size = float(np.linalg.norm(first) * np.linalg.norm(second))
    return float(first @ second) / size if size > 0.0 else -1.0
