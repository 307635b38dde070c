"""Every fault put into a good dataset is named by file, row and column, and nothing else is."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.runs import (
    Fault,
    Run,
    append_run,
    check_dataset,
    create_dataset,
    inspect_dataset,
    read_dataset,
    write_run,
)
from swamp_rl.runs.faults import condensed, faults_at
from swamp_rl.runs.table import read_table, write_table
from tests.support.runs import circling, described

Columns = dict[str, NDArray[np.float64]]
ROWS = len(circling()["time"])
OUT_OF_RANGE = {
    "heading": (-math.pi, "wrap it"),
    "azimuth_ss": (45.0, "degrees"),
    "throttle_bp": (-0.1, "outside [0, 1]"),
    "joy_angle": (-1.01, "outside [-1, 1]"),
    "yaw_rate": (30.0, "degrees"),
    "north": (1e18, "in m"),
    "east": (-1e300, "in m"),
    "surge": (-2e3, "in m/s"),
}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one good run, whose table a test may replace."""
    folder = tmp_path_factory.mktemp("data") / "runs"
    create_dataset(folder, described())
    append_run(folder, Run("run", circling()), "parquet")
    return folder


def faults_of(folder: Path, columns: Columns) -> list[Fault]:
    write_table(folder / "run.parquet", columns)
    return check_dataset(folder)


def test_a_good_dataset_has_no_fault(folder: Path) -> None:
    assert check_dataset(folder) == []


@given(
    st.integers(0, ROWS - 1), st.sampled_from(sorted(circling())), st.sampled_from([np.nan, np.inf, -np.inf])
)
def test_a_value_that_is_not_finite_is_found_where_it_stands(
    good: Path, row: int, column: str, value: float
) -> None:
    columns = circling()
    columns[column][row] = value
    (fault,) = faults_of(good, columns)
    assert (fault.file, fault.row, fault.column) == ("run.parquet", row + 1, column)
    assert "not a finite number" in fault.message


@given(st.integers(0, ROWS - 1), st.sampled_from(sorted(OUT_OF_RANGE)))
def test_a_value_out_of_range_is_found_where_it_stands(good: Path, row: int, column: str) -> None:
    columns = circling()
    columns[column][row], hint = OUT_OF_RANGE[column]
    (fault,) = faults_of(good, columns)
    assert (fault.row, fault.column) == (row + 1, column)
    assert hint in fault.message


@given(st.lists(st.tuples(st.integers(0, ROWS - 1), st.sampled_from(sorted(circling()))), min_size=1))
def test_all_of_several_faults_are_found(good: Path, places: list[tuple[int, str]]) -> None:
    columns = circling()
    for row, column in places:
        columns[column][row] = np.nan
    found = faults_of(good, columns)
    starts = {
        (row + 1, column) for row, column in places if row == 0 or not math.isnan(columns[column][row - 1])
    }
    assert {(fault.row, fault.column) for fault in found} == starts


@given(st.integers(1, ROWS - 1))
def test_a_row_that_does_not_come_later_is_found(good: Path, row: int) -> None:
    columns = circling()
    columns["time"][row] = columns["time"][row - 1]
    fault = faults_of(good, columns)[0]
    assert (fault.row, fault.column) == (row + 1, "time")
    assert "its own time" in fault.message


@pytest.mark.parametrize(
    ("names", "target", "remedy"),
    [
        (sorted(circling()), 5, "the row is there twice, leave one out"),
        (["time"], 5, "give each row its own time"),
        (["time"], 3, "put the rows in order of time"),
    ],
)
def test_a_time_that_does_not_increase_is_reported_with_its_own_remedy(
    good: Path, names: list[str], target: int, remedy: str
) -> None:
    columns = circling()
    for name in names:
        columns[name][6] = columns[name][target]
    (fault,) = [fault for fault in faults_of(good, columns) if fault.row == 7]
    assert fault.message.endswith(f"; {remedy}")


@given(st.integers(1, ROWS - 2))
def test_a_row_left_out_is_found_at_the_row_after_it(good: Path, row: int) -> None:
    columns = {name: np.delete(values, row) for name, values in circling().items()}
    fault = faults_of(good, columns)[0]
    assert (fault.row, fault.column) == (row + 1, "time")
    assert "0.2 s after the row before" in fault.message


@given(st.floats(2.0, 50.0).filter(lambda rate: abs(rate - 10.0) > 0.2))
def test_another_sample_rate_than_the_one_declared_is_named(good: Path, rate: float) -> None:
    columns = circling()
    columns["time"] = np.arange(ROWS) / rate
    del columns["yaw_rate"]
    fault = faults_of(good, columns)[0]
    assert fault.column == "time"
    assert f"{rate:.6g} Hz, not the 10 Hz of dataset.yaml" in fault.message


def test_times_rounded_to_milliseconds_are_still_a_fixed_rate(tmp_path: Path) -> None:
    columns = circling()
    columns["time"] = np.round(np.arange(ROWS) / 30.0, 3)
    del columns["yaw_rate"]
    create_dataset(tmp_path / "set", described(sample_rate=30.0))
    append_run(tmp_path / "set", Run("run", columns))
    assert check_dataset(tmp_path / "set") == []


@given(st.sampled_from(["time", "north", "east", "heading", "azimuth_bs", "throttle_sp"]))
def test_a_missing_column_is_named(good: Path, column: str) -> None:
    columns = circling()
    del columns[column]
    (fault,) = faults_of(good, columns)
    assert (fault.file, fault.column) == ("run.parquet", column)
    assert "is missing" in fault.message


def test_a_track_without_any_command_is_a_run_too(good: Path) -> None:
    columns = {name: values for name, values in circling().items() if "_b" not in name and "_s" not in name}
    assert faults_of(good, columns) == []


@pytest.mark.parametrize("column", ["heading", "yaw_rate"])
def test_small_angles_in_degrees_are_betrayed_by_the_other_column(good: Path, column: str) -> None:
    columns = circling()
    time = columns["time"]
    columns["heading"], columns["yaw_rate"] = 0.02 * np.sin(time), 0.02 * np.cos(time)
    assert faults_of(good, columns) == []
    columns[column] = np.degrees(columns[column])
    (fault,) = faults_of(good, columns)
    assert fault.column == column
    assert "degrees" in fault.message


@pytest.mark.parametrize(
    ("first", "factor", "message"), [(4.5, 1.0, "wrap it"), (0.05, 180.0 / math.pi, "degrees")]
)
def test_a_heading_beyond_a_turn_is_distinguished_from_one_in_degrees(
    good: Path, first: float, factor: float, message: str
) -> None:
    columns = circling()
    columns["heading"] = factor * (first + 0.8 * columns["time"])
    columns["yaw_rate"][:] = 0.8
    (fault,) = faults_of(good, columns)
    assert fault.column == "heading"
    assert message in fault.message


def test_a_column_wholly_in_degrees_is_one_fault_with_its_extent(good: Path) -> None:
    columns = circling()
    columns["azimuth_bs"] = np.full(ROWS, 45.0)
    (fault,) = faults_of(good, columns)
    assert (fault.row, fault.column) == (1, "azimuth_bs")
    assert str(fault).endswith(f"(in each of rows 1 to {ROWS}: {ROWS} rows)")


def test_rows_with_the_same_fault_here_and_there_are_reported_in_one_line() -> None:
    heading = np.array([359.0, 0.1, 358.5, 2.0, 0.2, -4.1])
    rows = np.arange(1, 7)
    of = partial("{:g} is outside [-1, 1] rad".format)
    faults = faults_at("a.csv", "heading", rows, np.abs(heading) > 1.0, lambda i: of(heading[i]))
    assert [(one.row, one.last) for one in faults] == [(1, 1), (3, 4), (6, 6)]
    whole, late = condensed([*faults[:2], Fault("a.csv", 5, "heading", "is missing", 5)])
    assert str(whole).endswith("359 is outside [-1, 1] rad (in 3 of rows 1 to 4)")
    assert str(late) == "a.csv: row 5 (line 6), column heading: is missing"


def test_an_azimuth_may_count_its_turns_but_not_jump_by_more_than_one(good: Path) -> None:
    columns = circling()
    columns["azimuth_bs"] = np.linspace(0.0, 12.6, ROWS)
    assert faults_of(good, columns) == []
    columns["azimuth_bs"][-1] += 7.0
    assert {fault.column for fault in faults_of(good, columns)} == {"azimuth_bs"}


def test_an_azimuth_in_degrees_that_is_turned_slowly_is_called_so(good: Path) -> None:
    columns = circling()
    columns["azimuth_bs"] = np.degrees(0.6 * np.sin(columns["time"]))
    faults = faults_of(good, columns)
    assert {fault.column for fault in faults} == {"azimuth_bs"}
    assert "looks like degrees" in faults[0].message


def test_throttle_in_percent_is_called_so(good: Path) -> None:
    columns = circling()
    columns["throttle_bs"] *= 100.0
    (fault,) = faults_of(good, columns)
    assert "percent" in fault.message


def test_a_thruster_the_boat_does_not_have_is_named(good: Path) -> None:
    (fault,) = faults_of(good, circling() | {"throttle_tunnel": np.zeros(ROWS)})
    assert fault.column == "throttle_tunnel"
    assert "azimuth_bs, throttle_bs, azimuth_bp, throttle_bp, azimuth_ss" in fault.message


def test_a_run_of_fewer_than_two_rows_is_no_run(good: Path) -> None:
    for rows, held in ((0, "no rows"), (1, "1 row")):
        faults = faults_of(good, {name: values[:rows] for name, values in circling().items()})
        assert held in faults[0].message


def test_a_run_that_lost_its_last_rows_is_found_by_their_number(good: Path) -> None:
    (fault,) = faults_of(good, {name: values[:-3] for name, values in circling().items()})
    assert f"holds {ROWS - 3} rows, dataset.yaml has {ROWS}" in fault.message


@given(st.floats(0.0, 0.999))
def test_a_parquet_file_cut_short_anywhere_is_one_fault(good: Path, part: float) -> None:
    write_table(good / "run.parquet", circling())
    whole = (good / "run.parquet").read_bytes()
    (good / "run.parquet").write_bytes(whole[: int(part * len(whole))])
    (fault,) = check_dataset(good)
    assert fault.file == "run.parquet"
    assert "cut short" in fault.message


@settings(derandomize=True)
@given(st.floats(0.0, 0.9999), st.integers(1, 255))
def test_a_changed_byte_of_a_parquet_file_never_passes_for_another_number(
    good: Path, part: float, change: int
) -> None:
    write_table(good / "run.parquet", circling())
    damaged = bytearray((good / "run.parquet").read_bytes())
    damaged[int(part * len(damaged))] ^= change
    (good / "run.parquet").write_bytes(damaged)
    found = inspect_dataset(good)
    if not found.faults:
        for name, values in circling().items():
            assert found.runs[0].columns.get(name, values).tobytes() == values.tobytes()


@given(st.data())
def test_a_csv_file_cut_short_anywhere_is_found(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    folder = tmp_path_factory.mktemp("cut")
    create_dataset(folder, described())
    path = append_run(folder, Run("run", circling(0.5)), "csv")
    whole = path.read_bytes()
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole) - 1))])
    assert {fault.file for fault in check_dataset(folder)} == {"run.csv"}


def edited(replace: Callable[[list[str]], None]) -> str:
    lines = ["time,north,east,heading", *(f"{0.1 * row:.1f},{row},0.5,0.1" for row in range(6))]
    replace(lines)
    return "\n".join(lines) + "\n"


CSV_FAULTS: dict[str, tuple[int, str, int | None, str | None, str]] = {
    "text": (3, "0.2,abc,0.5,0.1", 3, "north", "'abc' is not a number"),
    "an empty cell": (3, "0.2,,0.5,0.1", 3, "north", "is missing"),
    "a decimal comma": (3, '0.2,"1,5",0.5,0.1', 3, "north", "use a point"),
    "an underscore": (3, "0.2,1_0,0.5,0.1", 3, "north", "not a number"),
    "too few cells": (3, "0.2,2,0.5", 3, None, "has 3 values for 4 columns"),
    "too many cells": (3, "0.2,2,0.5,0.1,9", 3, None, "has 5 values for 4 columns"),
    "an empty line": (3, "", 3, "time", "is missing"),
    "a misspelt header": (0, "time,North,east,heading", None, "north", "'North' must be named 'north'"),
    "a header twice": (0, "time,north,north,heading", None, "north", "named twice"),
}


@pytest.mark.parametrize("what", CSV_FAULTS)
def test_a_csv_fault_is_named_by_row_and_line(tmp_path: Path, what: str) -> None:
    line, text, row, column, message = CSV_FAULTS[what]
    create_dataset(tmp_path, described())
    path = append_run(tmp_path, Run("run", circling(0.5)), "csv")

    def put(lines: list[str]) -> None:
        lines[line] = text

    path.write_text(edited(put))
    fault = check_dataset(tmp_path)[0]
    assert (fault.row, fault.column) == (row, column)
    assert message in fault.message
    assert row is None or f"row {row} (line {row + 1})" in str(fault)


def test_rows_after_a_broken_one_keep_their_numbers(tmp_path: Path) -> None:
    create_dataset(tmp_path, described())
    path = append_run(tmp_path, Run("run", circling(0.5)), "csv")

    def put(lines: list[str]) -> None:
        lines[2], lines[5] = "0.1,1", "0.4,nan,0.5,0.1"

    path.write_text(edited(put))
    assert [(fault.row, fault.column) for fault in check_dataset(tmp_path)] == [(2, None), (5, "north")]


@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_table_of_semicolons_or_tabs_with_decimal_commas_is_the_same_table(
    tmp_path: Path, separator: str
) -> None:
    create_dataset(tmp_path, described())
    path = append_run(tmp_path, Run("run", circling(0.5)), "csv")
    path.write_text(edited(lambda lines: None))
    whole = read_table(path)
    path.write_text(edited(lambda lines: None).replace(",", separator).replace(".", ","))
    there = read_table(path)
    assert not there.faults and list(there.columns) == list(whole.columns)
    for name, values in whole.columns.items():
        assert there.columns[name] == pytest.approx(values, nan_ok=True), name


def test_a_file_that_is_not_utf_8_is_one_fault(tmp_path: Path) -> None:
    create_dataset(tmp_path, described())
    path = append_run(tmp_path, Run("run", circling(0.5)), "csv")
    path.write_bytes("time,north,east,heading,temp\xe9rature\n".encode("latin-1"))
    (fault,) = check_dataset(tmp_path)
    assert fault.file == "run.csv"


def test_reading_stops_at_the_first_fault_and_counts_the_rest(good: Path) -> None:
    columns = circling()
    columns["north"][4] = columns["east"][9] = np.nan
    faults_of(good, columns)
    with pytest.raises(UserError, match=r"run\.parquet: row 5, column north: .*\(and 1 more"):
        read_dataset(good)


def test_a_run_with_a_fault_is_never_written(tmp_path: Path) -> None:
    columns = circling()
    columns["north"][4] = np.nan
    with pytest.raises(UserError, match=r"row 5 \(line 6\), column north"):
        write_run(tmp_path / "run.csv", Run("run", columns))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name", ["=HYPERLINK(0)", "+1", "-2", "@SUM(A1)", " =1", "\t=1", "a\x1b[31m", "two\nlines", "y" * 201]
)
@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_column_on_whose_name_a_spreadsheet_or_a_terminal_acts_is_named_and_never_written(
    kind: Literal["csv", "parquet"], name: str, tmp_path: Path
) -> None:
    create_dataset(tmp_path, described())
    columns = circling(0.5)
    with pytest.raises(UserError, match="is not a column name"):
        append_run(tmp_path, Run("run", columns | {name: columns["north"]}), kind)
    assert not list(tmp_path.glob("run.*"))
    path = append_run(tmp_path, Run("run", columns), kind)
    write_table(path, columns | {name: columns["north"]})
    faults = [str(fault) for fault in check_dataset(tmp_path)]
    assert [fault for fault in faults if "is not a column name" in fault] != []
    assert all(fault.isprintable() and len(fault) < 400 for fault in faults)
