"""The validation judges by the printed numbers."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.validation.check import count, reasons
from benchmarks.validation.coefficients import coefficient_rows
from benchmarks.validation.sources import esso_parts, row_table, worst_table
from benchmarks.validation.swamp import (
    FULL,
    LIGHT,
    THRUST_TABLE,
    Row,
    deduction_rows,
    force_rows,
    tank_rows,
    thrust_errors,
)


def test_a_limit_is_met_below_it_and_a_number_is_not() -> None:
    limit = Row("a", "s", "under 2 m", 2.0, 1.5, 3.0, FULL, limit=True)
    plain = Row("a", "s", "2 m", 2.0, 1.5, 3.0, FULL)
    assert limit.mismatch == 0.0
    assert plain.mismatch == pytest.approx(-0.25)
    assert Row("a", "s", "under 2 m", 2.0, 1.5, 3.0, LIGHT, limit=True).mismatch == pytest.approx(0.5)


def test_the_largest_mismatches_are_those_above_a_tenth_the_worst_first() -> None:
    rows = [
        Row(name, "s", "1", 1.0, value, math.nan, FULL)
        for name, value in (("a", 1.2), ("b", 0.95), ("c", 0.5))
    ]
    assert [line.split(" | ")[0] for line in worst_table(rows).splitlines()[2:]] == ["| c", "| a"]
    assert worst_table(rows).splitlines()[2].endswith("| -50 % |")
    assert "**0.95**" in row_table(rows)


def test_a_number_with_two_readings_counts_once_by_the_nearer_one() -> None:
    steady, tactical = (
        Row(w, "s", "9", 9.0, v, v, FULL, reading_of="D") for w, v in (("a", 9.1), ("b", 12.0))
    )
    other = Row("c", "s", "1", 1.0, 2.0, 2.0, FULL)
    assert count([steady, tactical, other]) == (2, 1, 0)


def test_half_a_unit_of_the_last_digit_is_tolerated_where_it_is_more() -> None:
    charge = Row("a", "s", "0.02", 0.02, 0.024, math.nan, FULL, width=0.005, reason="because.")
    assert charge.mismatch == pytest.approx(0.2) and charge.met
    assert not replace(charge, full=0.026).met
    assert reasons([charge, replace(charge, what="b", full=0.026)]) == "* b, s: because."


def test_the_thrust_deduction_comes_back_from_the_speeds() -> None:
    # At steady speed the resistance is the thrust, so eq. 7.3 must return 1 - 0.86 V / V_o of the boat file.
    for percent, speed, factor in deduction_rows():
        jet_speed = percent / 100 * math.sqrt(12.2 / (1025 * 900e-6))
        assert factor == pytest.approx(1 - 0.86 * speed / jet_speed, abs=0.005)


def test_the_tank_is_reproduced_and_a_depth_left_out_is_not() -> None:
    rows = {row.depth: row for row in tank_rows()}
    assert sum(row.points for row in rows.values()) == 28
    assert all(row.errors[0] < 1e-9 for row in rows.values())
    assert math.isnan(rows["h/T = 9"].errors[1])
    assert 0.02 < rows["h/T = 2.5"].errors[2] <= rows["h/T = 2.5"].errors[1]


def test_the_thrust_table_is_met_to_its_last_digit() -> None:
    largest, mean = thrust_errors()
    assert len(THRUST_TABLE) == 19
    assert mean < largest <= 0.05 + 1e-9
    assert force_rows()[3].full == pytest.approx(12.2)


def test_every_missed_number_of_the_tank_has_its_sentence() -> None:
    for row in (*force_rows(), *coefficient_rows()):
        assert row.met or row.reason.endswith("."), row.what


def test_without_the_measured_runs_their_tables_are_left_as_they_are(tmp_path: Path) -> None:
    assert esso_parts(tmp_path / "nowhere") == {}
