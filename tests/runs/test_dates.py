"""Dates and times as spreadsheets write them."""

from datetime import UTC, datetime
from pathlib import Path

import pyarrow as pa
import pytest

from swamp_rl.logs.import_logs import read_log
from swamp_rl.logs.listing import listing
from swamp_rl.runs.stamps import Stamps, from_words

START = datetime(2024, 5, 14, 9, 20, tzinfo=UTC).timestamp()


def stamps(*cells: str) -> Stamps:
    found = from_words(pa.chunked_array([pa.array(cells)]))
    assert found is not None
    return found


@pytest.mark.parametrize(
    "cells",
    [
        ("14.05.2024 09:20:00", "14.05.2024 09:20:00,5"),
        ("14.5.2024, 9:20:00", "14.5.2024, 9:20:00.5"),
        ("5/14/2024 9:20:00 AM", "5/14/2024 9:20:00.5 AM"),
        ("14/05/2024 09:20:00", "14/05/2024 09:20:00.5"),
        ("2024/05/14 9:20", "2024/05/14 9:20:00.500"),
    ],
)
def test_a_date_and_a_time_of_day_is_a_moment(cells: tuple[str, str]) -> None:
    found = stamps(*cells)
    assert found.start == START
    assert found.time == pytest.approx([0.0, 0.5])
    assert "from 2024-05-14T09:20:00.000+00:00" in str(found.note)


def test_of_two_orders_of_day_and_month_the_one_of_the_shorter_log_holds() -> None:
    over_midnight = stamps("05/06/2024 23:59:59", "06/06/2024 00:00:01")
    assert over_midnight.time == pytest.approx([0.0, 2.0])
    assert datetime.fromtimestamp(over_midnight.start, UTC).month == 6


def test_a_date_that_may_be_of_either_order_is_reported_and_starts_alike_in_all_tables() -> None:
    found = stamps("05/06/2024 12:00:00", "05/06/2024 12:00:01")
    assert found.time == pytest.approx([0.0, 1.0])
    assert "not known" in str(found.note)
    assert stamps("05/06/2024 12:00:03").start == found.start + 3.0
    assert stamps("05/05/2024 12:00:00").start > 0.0  # the same in both


def test_a_cell_that_is_no_moment_is_missing_and_words_are_no_times() -> None:
    found = stamps("14.05.2024 09:20:00", "31.02.2024 09:20:00", "")
    assert found.time == pytest.approx([0.0, float("nan"), float("nan")], nan_ok=True)
    assert from_words(pa.chunked_array([pa.array(["AUTO", "MANUAL"])])) is None


def test_a_listing_tells_a_column_of_times_from_one_of_other_words(tmp_path: Path) -> None:
    rows = ["UTC,mode", "2025-06-03T09:15:01+00:00,AUTO", "2025-06-03T09:15:02+00:00,AUTO"]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    assert list(listing(read_log(tmp_path / "log.csv", "csv")))[1:] == [
        "  UTC: times, as '2025-06-03T09:15:01+00:00'",
        "  mode: no numbers, as 'AUTO'",
    ]
