"""Checks of printed numbers: tolerances, readings, reasons; the designs' bars."""

from benchmarks.validation.check import Check, check, check_table, count, count_table, reasons
from benchmarks.validation.design import design_groups, design_parts
from benchmarks.validation.hull import hull_checks
from benchmarks.validation.matching import independent_checks, matching_checks
from benchmarks.validation.pump_jet import pump_jet_checks


def test_the_wider_tolerance_counts() -> None:
    assert check("a", "s", 0.08, 0.0765, 0.03, 0.005).met
    assert not check("a", "s", 0.08, 0.0765, 0.03, 0.001).met
    assert check("a", "s", -10.0, -10.2, 0.03).met
    assert not check("a", "s", 10.0, 10.31, 0.03).met


def test_a_range_is_met_within_it_and_near_its_ends() -> None:
    for ours, met in ((2.0, False), (2.95, True), (4.0, True), (5.1, True), (5.2, False)):
        assert Check("a", "s", "3 to 5", 3.0, 5.0, ours, 0.03).met == met


def test_readings_of_a_number_count_once_by_the_one_that_is_met() -> None:
    pair = [check(what, "s", 1.0, value, 0.03, reading_of="n") for what, value in (("a", 1.0), ("b", 2.0))]
    missed = check("c", "s", 1.0, 2.0, 0.03, reason="because.")
    assert count([*pair, missed]) == (2, 1, 0)
    assert (
        count_table({"x": [*pair, missed], "y": [missed]}).splitlines()[-1]
        == "| all | 3 | 1 | 33 % | 0 | 33 % |"
    )
    against = check("d", "s", 1.0, 2.0, 0.03, reason="the source says so.", contradicted=True)
    assert count([*pair, missed, against]) == (3, 1, 1)
    assert (
        count_table({"x": [*pair, missed, against]}).splitlines()[-1] == "| all | 3 | 1 | 33 % | 1 | 50 % |"
    )
    assert reasons([missed]) == "* c, s: because."
    assert "**missed**" in check_table([missed])


def test_every_missed_number_has_its_sentence() -> None:
    for one in (*pump_jet_checks(), *hull_checks(), *matching_checks()):
        assert one.met or one.reason.endswith("."), one.what


def test_table_5_1_and_the_independent_programs_numbers_are_met() -> None:
    assert all(one.met for one in pump_jet_checks() if one.source == "table 5.1")
    assert all(one.met for one in independent_checks())


def test_the_parts_are_those_that_the_document_has_marks_for() -> None:
    from benchmarks.markers import DOCS

    page = (DOCS / "validation.md").read_text(encoding="utf-8")
    for name in design_parts(design_groups()):
        assert f"<!-- {name} -->" in page and f"<!-- end {name} -->" in page
