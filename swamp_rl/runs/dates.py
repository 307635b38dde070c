"""Dates and times as spreadsheets write them: 14.05.2024 09:20:00.5, 5/14/2024 9:20 AM, 2024/05/14 9:20."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any, NamedTuple

DATED = re.compile(
    r"(\d{1,4})([./-])(\d{1,2})\2(\d{1,4})[ T,]\s*"
    r"(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d{1,9})?))?\s*([AaPp][Mm])?",
    re.ASCII,
)
NOON = 12


class Dated(NamedTuple):
    """Moments, None where a cell is none; `known`: whether the order of day and month is; where it is not,
    `moments` has the day first and `month_first` the month."""

    moments: list[datetime | None]
    known: bool
    month_first: Sequence[datetime | None] = ()


def from_dates(cells: Sequence[Any]) -> Dated | None:
    """Moments (UTC) of cells with a date and a time of day; None where no cell has both.

    A year comes first or last. Dots separate day, month and year. Of the others the order of day and month
    is that in which all rows are dates and the rows span the shorter time; it is not known where both are
    the same.
    """
    found = [DATED.fullmatch(cell.strip()) if isinstance(cell, str) else None for cell in cells]
    first = next((one for one in found if one is not None), None)
    if first is None:
        return None
    if len(first[1]) == 4:
        return Dated([_moment(one, 1, 3, 4) for one in found], True)
    day_first = [_moment(one, 4, 3, 1) for one in found]
    if first[2] == ".":
        return Dated(day_first, True)
    month_first = [_moment(one, 4, 1, 3) for one in found]
    orders = sorted((day_first, month_first), key=lambda one: (one.count(None), _span(one)))
    same = [(one.count(None), _span(one)) for one in orders]
    return Dated(orders[0], same[0] != same[1] or orders[0] == orders[1], orders[1])


def _moment(found: re.Match[str] | None, year: int, month: int, day: int) -> datetime | None:
    """The groups of a cell as a moment, `year`, `month` and `day` by their places."""
    if found is None:
        return None
    hour, half = int(found[5]), (found[8] or "").lower()
    if half:
        hour = hour % NOON + (NOON if half == "pm" else 0)
    try:
        start = datetime(
            int(found[year]), int(found[month]), int(found[day]), hour, int(found[6]), tzinfo=UTC
        )
        return start + timedelta(seconds=float((found[7] or "0").replace(",", ".")))
    except (ValueError, OverflowError):
        return None


def _span(moments: Sequence[datetime | None]) -> float:
    """Seconds from the first to the last of all."""
    known = [one for one in moments if one is not None]
    return (max(known) - min(known)).total_seconds() if known else 0.0
