"""Times as logs write them: seconds, ticks since 1970, ISO 8601, dates and times of spreadsheets."""

from dataclasses import dataclass
from datetime import UTC, date, datetime
from datetime import time as time_of_day
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from swamp_rl.logs.dates import from_dates
from swamp_rl.runs.import_telemetry import EPOCHS

Array = NDArray[np.float64]
TICKS = {1: "s", 10**3: "ms", 10**6: "us", 10**9: "ns"}


@dataclass(frozen=True)
class Stamps:
    """`time` (T,) s from the first one, NaN where there is none; `start`: that one in s since 1970, 0 where
    the log does not say; `told`: what the log writes."""

    time: Array
    start: float
    told: str | None


def from_numbers(stamps: Array) -> Stamps:
    """Ticks since 1970, recognised by their size, as times from the first; other numbers stay as they are."""
    known = stamps[np.isfinite(stamps)]
    for ticks, (low, high) in EPOCHS.items():
        if len(known) and low <= known.min() and known.max() < high:
            start = float(known[0]) / ticks
            return Stamps(
                (stamps - known[0]) / ticks, start, f"{TICKS[ticks]} since 1970, from {_iso(start)}"
            )
    return Stamps(stamps, 0.0, None)


def from_words(cells: pa.ChunkedArray) -> Stamps | None:
    """Stamps in ISO 8601, of spreadsheets, or typed as times; None where no cell is one. Without a zone they
    are UTC.

    Times of a day without the day, or with one of which day and month may be either, begin at no known one.
    """
    given = cells.to_pylist()
    if (clock := _times_of_day(given)) is not None:
        return clock
    stamps, told, known = [_stamp(cell) for cell in given], "ISO 8601", True
    if all(stamp is None for stamp in stamps) and (dated := from_dates(given)) is not None:
        stamps, told, known = dated.moments, "dates and times", dated.known
    first = next((stamp for stamp in stamps if stamp is not None), None)
    if first is None:
        return None
    time = np.array([np.nan if stamp is None else (stamp - first).total_seconds() for stamp in stamps])
    if not known:
        return Stamps(time, 0.0, "dates and times, of which the order of day and month is not known")
    return Stamps(time, first.timestamp(), f"{told}, from {_iso(first.timestamp())}")


def _times_of_day(cells: list[Any]) -> Stamps | None:
    """Stamps of cells such as 14:05:00.1; None where the first is none of these."""
    if not cells or _time_of_day(cells[0]) is None:
        return None
    time = np.array([np.nan if (found := _time_of_day(cell)) is None else found for cell in cells])
    return Stamps(time - time[0], 0.0, f"of a day, from {str(cells[0]).strip()}")


def _time_of_day(cell: Any) -> float | None:
    """Seconds since midnight."""
    if not isinstance(cell, str):
        return None
    try:
        found = datetime.combine(date.min, time_of_day.fromisoformat(cell.strip()))
    except ValueError:
        return None
    return (found.replace(tzinfo=None) - datetime.min).total_seconds()


def _iso(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")


def _stamp(cell: Any) -> datetime | None:
    if isinstance(cell, str):
        try:
            cell = datetime.fromisoformat(cell.strip())
        except ValueError:
            return None
    if not isinstance(cell, datetime):
        return None
    return cell if cell.tzinfo else cell.replace(tzinfo=UTC)
