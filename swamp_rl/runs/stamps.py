"""Times as logs write them: seconds, ticks since 1970, ISO 8601, dates and times of spreadsheets."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, timedelta
from datetime import time as time_of_day

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from swamp_rl.constants import DAY
from swamp_rl.errors import UserError
from swamp_rl.runs.dates import from_dates
from swamp_rl.runs.table import TICKS, cell_text, is_text

Array = NDArray[np.float64]
UNIT = {ticks: unit for unit, ticks in TICKS.items()}
EPOCHS = {1: (10**9, 10**10), 10**3: (10**12, 10**13), 10**6: (10**15, 10**16), 10**9: (10**18, 10**19)}
"""Ticks in a second, by the span of stamps since 1970 that then fall into the years 2001 to 2286."""
NO_TIME = "is not a time; correct it or cut the row"
ZERO = datetime(1970, 1, 1, tzinfo=UTC)
YEARS = -62_135_596_800, 253_402_300_800
"""s since 1970 of the years 1 to 9999."""
PAST_MIDNIGHT = ", past midnight"
SLOWEST = 10.0
"""s between rows: a log whose numbers are that far apart counts in ms or finer, at up to 100 rows a second.
A diagnosis needs a row every second."""
FASTEST = 5e-5
"""s between rows, that those of a log are not; those of 0.3 Hz are, if times in days are taken for s."""
USUAL = 0.1
"""s between rows."""


@dataclass(frozen=True)
class Stamps:
    """`time` (T,) s from the first one, NaN where there is none; `start`: that one in s, on the log's clock:
    since 1970, of times of a day since midnight, of other numbers since their zero; `note`: what the log
    writes; `of_a_day`: whether it is times of a day; `month_first`: of dates of which the order of day and
    month is not known, the start were the month first."""

    time: Array
    start: float
    note: str | None
    of_a_day: bool = False
    month_first: float | None = None


@np.errstate(over="ignore", invalid="ignore")  # numbers near the end of their range are no times
def from_numbers(stamps: Array, where: str, unit: float | None = None) -> Stamps:
    """Numbers (T,) in `unit` [s] as times: ticks since 1970 where the median is of such a size, others NaN.

    By default the unit is that of such ticks, else seconds. UserError, which begins with `where`, for a
    default unit, or a given one below 1 s, in which the rows are SLOWEST or more apart, and for a given one
    in which they are less than FASTEST apart.
    """
    known = stamps[np.isfinite(stamps)]
    middle = float(np.median(known)) if len(known) else np.nan
    spans = {ticks: span for ticks, span in EPOCHS.items() if unit in (None, 1.0 / ticks)}
    ticks = next((ticks for ticks, (low, high) in spans.items() if low <= middle < high), None)
    if ticks is not None:
        low, high = spans[ticks]
        stamps = np.where((stamps >= low) & (stamps < high), stamps, np.nan)
        known = stamps[np.isfinite(stamps)]
    first = float(known[0]) if len(known) else 0.0
    since = stamps - first
    time = since / ticks if ticks else since * (unit or 1.0)
    steps = np.diff(time[np.isfinite(time)])
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if unit is None and step >= SLOWEST:
        kind = f"{UNIT[ticks]} since 1970" if ticks else "s"
        raise UserError(
            f"{where}: the rows are {step:.3g} s apart if the numbers are {kind}; give their unit, as in "
            "--unit time=ms (us, ns), or time=s for rows so far apart"
        )
    if unit is not None and step > 0.0 and (step < FASTEST or (unit < 1.0 and step >= SLOWEST)):
        likely = min(UNIT, key=lambda ticks: abs(math.log(step / unit / ticks / USUAL)))
        raise UserError(
            f"{where}: the rows are {step:.3g} s apart in the unit given, {step / unit / likely:.3g} s in "
            f"{UNIT[likely]}; correct it, as in --unit time={UNIT[likely]}"
        )
    if ticks is None:
        return Stamps(time, first * (unit or 1.0), None)
    return Stamps(time, first / ticks, f"{UNIT[ticks]} since 1970, from {_iso(first / ticks)}")


def from_words(cells: pa.ChunkedArray) -> Stamps | None:
    """Stamps in ISO 8601, times of a day, of spreadsheets, or typed as times; None where no cell is one.
    Without a zone they are UTC.

    Where the order of day and month is not known, `start` takes the day first, as in any other table.
    """
    if pa.types.is_timestamp(cells.type):
        return _since_1970(cells.cast(pa.int64()), TICKS[cells.type.unit], "ISO 8601")
    if pa.types.is_time(cells.type):
        ticks = cells.cast(pa.int32() if pa.types.is_time32(cells.type) else pa.int64())
        whole = pc.cast(ticks, pa.float64(), safe=False)
        return _of_a_day(cells, pc.divide(whole, float(TICKS[cells.type.unit])))
    if not is_text(cells.type):
        return None
    given = cells.to_pylist()
    if (found := _since_1970(_microseconds(map(_stamp, given)), TICKS["us"], "ISO 8601")) is not None:
        return found
    if (found := _of_a_day(cells, pa.array(map(_time_of_day, given), pa.float64()))) is not None:
        return found
    if (dated := from_dates(given)) is None:
        return None
    found = _since_1970(_microseconds(dated.moments), TICKS["us"], "dates and times")
    if found is None or dated.known:
        return found
    other = _since_1970(_microseconds(dated.month_first), TICKS["us"], "")
    return Stamps(
        found.time,
        found.start,
        "dates and times, of which the order of day and month is not known",
        month_first=None if other is None else other.start,
    )


def _microseconds(moments: Iterable[datetime | None]) -> pa.Array:
    """Moments, None where there is none, since 1970."""
    one = timedelta(microseconds=1)
    return pa.array([None if moment is None else (moment - ZERO) // one for moment in moments], pa.int64())


def _since_1970(stamps: pa.ChunkedArray | pa.Array, ticks: int, note: str) -> Stamps | None:
    """Whole ticks since 1970, missing outside YEARS; None where all are."""
    whole = np.asarray(pc.fill_null(stamps, 0))
    known = np.asarray(pc.is_valid(stamps)) & (whole >= YEARS[0] * ticks) & (whole < YEARS[1] * ticks)
    if not known.any():
        return None
    first = int(whole[np.argmax(known)])
    time = np.where(known, (whole - first) / ticks, np.nan)
    return Stamps(time, first / ticks, f"{note}, from {_iso(first / ticks)}")


def _of_a_day(cells: pa.ChunkedArray, seconds: pa.ChunkedArray | pa.Array) -> Stamps | None:
    """Cells such as 14:05:00.1 with their seconds since midnight, null for one that is none, missing beyond a
    day; None where all are. A step back by more than half a day is midnight, which is counted past."""
    time = np.asarray(pc.fill_null(seconds, np.nan))
    time = np.where((time >= 0.0) & (time < DAY), time, np.nan)
    known = np.flatnonzero(np.isfinite(time))
    if not len(known):
        return None
    first = int(known[0])
    days = -np.cumsum(np.round(np.diff(time[known], prepend=time[first]) / DAY))
    time[known] += days * DAY
    note = f"of a day, from {cell_text(cells, first).strip()}{PAST_MIDNIGHT if days.any() else ''}"
    return Stamps(time - time[first], float(time[first]), note, of_a_day=True)


def on_one_day(stamps: Mapping[str, Stamps]) -> dict[str, Stamps]:
    """Stamps by tables of one log: those of a day begin within half a day of the first table with a date, or
    without one of the first of them. Where the order of day and month is not known, it is the one nearer to
    the first date of which it is.
    """
    dated = {name: one for name, one in stamps.items() if one.note and not one.of_a_day}
    date = next((one.start for one in dated.values() if one.month_first is None), None)
    ordered = {name: _ordered(one, date) for name, one in stamps.items()}
    firsts = [ordered[name].start for name in dated]
    first = next(iter(firsts + [one.start for one in ordered.values() if one.of_a_day]), 0.0)
    return {
        name: replace(one, start=one.start + DAY * round((first - one.start) / DAY)) if one.of_a_day else one
        for name, one in ordered.items()
    }


def _ordered(one: Stamps, date: float | None) -> Stamps:
    """The stamps, their day and month in the order with the start nearest to a date [s since 1970]."""
    if one.of_a_day or one.month_first is None or date is None:
        return one
    start = min(one.start, one.month_first, key=lambda start: abs(start - date))
    return replace(one, start=start, note=f"dates and times, from {_iso(start)}", month_first=None)


def _time_of_day(cell: str | None) -> float | None:
    """Seconds since midnight."""
    try:
        found = datetime.combine(date.min, time_of_day.fromisoformat((cell or "").strip()))
    except ValueError:
        return None
    return (found.replace(tzinfo=None) - datetime.min).total_seconds()


def _stamp(cell: str | None) -> datetime | None:
    try:
        found = datetime.fromisoformat((cell or "").strip())
    except ValueError:
        return None
    return found if found.tzinfo else found.replace(tzinfo=UTC)


def _iso(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
