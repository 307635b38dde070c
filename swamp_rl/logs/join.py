"""Series with times of their own on one even grid of times."""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.resample import at_times, is_held, most_rows

Array = NDArray[np.float64]

POSITIONS = "north", "x", "latitude"
LEAST_REGULAR = 0.1
"""Length of the stamps' mean direction, below which no phase is theirs."""
NEAR = 1e-3
"""Steps that a phase is kept at 0 within."""
GAP_STEPS = 5.0
"""Median steps of a table: after a longer pause its values are not interpolated."""
REGULAR, FEWEST = 0.5, 20
"""Of the steps between commands sent at a rate: greatest width of the middle 80 %, in medians, and least
number."""


@dataclass(frozen=True)
class Series:
    """Values (T,) of one column at their times (T,) [s], and the table that has them; `lost`: increasing
    times [s] of cells of the table without a value, and the faults that tell why."""

    table: str
    time: Array
    values: Array
    lost: Sequence[tuple[float, Fault]] = ()


@dataclass(frozen=True)
class Joined:
    """`columns` (N,) with `time`, NaN and `unread` where a table pauses, the faults that say so, and what was
    done."""

    columns: dict[str, Array]
    unread: dict[str, NDArray[np.bool_]]
    faults: list[Fault]
    note: str


def joined(file: str, series: Mapping[str, Series], rate: float, fill: float) -> Joined:
    """All series at `rate` [Hz] over the time that all of them cover; linear, angles the short way round,
    commands held.

    Where the messages of a table pause for more than GAP_STEPS median steps and `fill` [s], its columns are
    missing. Commands that are sent at changes only are held over any silence. UserError where nothing is in
    common.
    """
    series = {name: _whole(file, name, one) for name, one in series.items()}
    if all(map(is_held, series)):
        raise UserError(f"{file}: the mapping has commands alone; map north and east, and heading")
    start, first = max((float(one.time[0]), one.table) for one in series.values())
    end, last = min((_end(name, one, fill), one.table) for name, one in series.items())
    start += _phase(series, start, rate)
    rows = (end - start) * rate + 1.0 + 1e-9
    if rows < 2.0:
        spans = "; ".join(_spans(series))
        raise UserError(
            f"{file}: the tables have no time in common ({spans}); map other tables, or, for clocks that are "
            f"hours apart, --map {last}.time='COLUMN + SECONDS'"
        )
    given = max(len(one.time) for one in series.values())
    most = most_rows(len(series) + 1, given)
    if not rows < most:
        message = f"{rows:.3g} rows at {rate:g} a second from {given} messages, at most {most}"
        raise UserError(f"{file}: {message}; give --resample HZ, or divide the log where its times jump")
    even = start + np.arange(math.floor(rows)) / rate
    columns: dict[str, Array] = {"time": even - start}
    unread: dict[str, NDArray[np.bool_]] = {}
    faults: list[Fault] = []
    for name, one in series.items():
        columns[name] = at_times("heading" if name == "yaw" else name, one.time, one.values, even)
        if _is_sent_at_changes(name, one):
            continue
        missing, found = _pauses(file, name, one, even, max(fill, 1.0 / rate))
        if missing.any():
            unread[name], columns[name] = missing, np.where(missing, np.nan, columns[name])
            faults += found
    message = "; ".join([_summary(series, rate), *_left_out(series, rate, even, first, last)])
    return Joined(columns, unread, faults, message)


def _end(name: str, one: Series, fill: float) -> float:
    """The last time [s] at which a series is known; a command is held as long as over a pause."""
    if _is_sent_at_changes(name, one):
        return math.inf
    return float(one.time[-1]) + (max(_longest_step(one), fill) if is_held(name) else 0.0)


def _longest_step(one: Series) -> float:
    """Seconds beyond which messages of a table pause."""
    return GAP_STEPS * float(np.median(np.diff(one.time)))


def _is_sent_at_changes(name: str, one: Series) -> bool:
    """Whether silence of a series says that it did not change: of commands that do not come at a rate, and of
    the joypad, which is silent where nobody holds it."""
    steps = np.diff(one.time)
    low, middle, high = np.quantile(steps, (0.1, 0.5, 0.9))
    regular = len(steps) >= FEWEST and high - low <= REGULAR * middle
    return is_held(name) and (name.startswith("joy_") or not regular)


def _phase(series: Mapping[str, Series], start: float, rate: float) -> float:
    """Seconds [0, 1/rate) from `start` to rows that lie next to the stamps of the positions.

    Linear interpolation halfway between two stamps averages them: the noise would lose what is near the
    Nyquist frequency. The phase is the mean direction of the stamps on the circle of one step.
    """
    place = next((series[name] for name in POSITIONS if name in series), next(iter(series.values())))
    turns = (place.time - start) * rate
    mean = np.exp(2j * np.pi * turns).mean()
    phase = float(np.angle(mean)) / (2.0 * np.pi) if abs(mean) > LEAST_REGULAR else 0.0
    return 0.0 if abs(phase) < NEAR else (phase % 1.0) / rate


def _whole(file: str, name: str, one: Series) -> Series:
    """The finite values at increasing times: of messages with one stamp the last."""
    known = np.isfinite(one.values) & np.isfinite(one.time)
    time, values = one.time[known], one.values[known]
    order = np.argsort(time, kind="stable")
    time, values = time[order], values[order]
    last = np.append(np.diff(time) > 0.0, True)[: len(time)]
    if last.sum() < 2:
        raise UserError(f"{file}: {one.table} has fewer than two values of {name}; map another field")
    return replace(one, time=time[last], values=values[last])


def _pauses(
    file: str, name: str, one: Series, even: Array, shortest: float
) -> tuple[NDArray[np.bool_], list[Fault]]:
    steps = np.diff(one.time)
    long = np.flatnonzero(steps > max(_longest_step(one), shortest))
    missing = np.zeros(len(even), bool)
    faults = []
    for i in long.tolist():
        first, last = np.searchsorted(even, [one.time[i] + 1e-9, one.time[i + 1] - 1e-9])
        missing[first:last] = True
        if last > first:
            message = f"{one.table} has no value for {steps[i]:.3g} s{_cause(one, i)}"
            message += "; --fill SECONDS fills it, --bad-rows cuts"
            faults.append(Fault(file, int(first) + 1, name, message, int(last), pause=True))
    return missing, faults


def _cause(one: Series, i: int) -> str:
    """The first cell without a value between two rows of a series, where there is one."""
    first = bisect_right(one.lost, one.time[i], key=itemgetter(0))
    if first == len(one.lost) or one.lost[first][0] >= one.time[i + 1]:
        return ""
    return f" ({str(one.lost[first][1]).partition(';')[0]})"


def _tables(series: Mapping[str, Series]) -> dict[str, Series]:
    return {one.table: one for one in series.values()}


def _spans(series: Mapping[str, Series]) -> Sequence[str]:
    return [f"{name} {one.time[0]:.3f} to {one.time[-1]:.3f} s" for name, one in _tables(series).items()]


def _summary(series: Mapping[str, Series], rate: float) -> str:
    rates = [
        f"{name} {1.0 / float(np.median(np.diff(one.time))):.3g} Hz" for name, one in _tables(series).items()
    ]
    return f"{', '.join(rates)}; at {rate:g} Hz, linear between messages, commands held"


def _left_out(series: Mapping[str, Series], rate: float, even: Array, first: str, last: str) -> list[str]:
    """What to tell of the time before and after the rows, in which the tables `first` and `last` have no
    messages."""
    before = float(even[0]) - min(float(one.time[0]) for one in series.values())
    after = max(float(one.time[-1]) for one in series.values()) - float(even[-1])
    parts = ("first", before, first), ("last", after, last)
    return [
        f"the {which} {seconds:.3g} s left out, without messages of {table}"
        for which, seconds, table in parts
        if seconds > GAP_STEPS / rate
    ]
