"""What differs between the datasets of one boat, and what they share with other boats."""

import math
import warnings
from collections.abc import Mapping

import pytest
from swamp_rl.experiments.fleet.changes import changes_of, heterogeneity
from swamp_rl.experiments.fleet.result import Change, Drift, Member
from swamp_rl.experiments.fleet.significance import findings_of, shared_causes, weather_of

from swamp_rl.criticism.result import Cause, Diagnosis
from tests.support.fleets import cause, diagnosis


def of_one_boat(found: Mapping[str, Diagnosis]) -> tuple[list[Drift], list[Change]]:
    members = [Member(name=name, boat="one", dataset=name) for name in found]
    return changes_of(members, found, findings_of(members, found)[0])


def mass(value: float = 40.0, error: float = 1.0) -> Cause:
    return cause("mass", "mass", value, error, 90.0, "kg")


def current() -> Cause:
    return cause("current", "north", 0.1, 0.01, 90.0, "m/s")


def test_parameters_that_one_dataset_lacks_or_that_are_no_number_are_not_compared() -> None:
    found = {
        "a": diagnosis(cause("mass", "mass", 60.0, 1.0, 90.0)),
        "b": diagnosis(cause("mass", "other", 80.0, 1.0, 90.0)),
        "c": diagnosis(cause("mass", "mass", math.nan, 1.0, 90.0)),
    }
    members = [Member(name=name, boat="one", dataset=name) for name in found]
    findings, _ = findings_of(members, found)
    assert changes_of(members, found, findings) == ([], [])


def test_a_parameter_that_some_runs_do_not_determine_is_compared_among_the_others() -> None:
    values = {"a": 60.0, "b": 65.0, "c": 70.0}
    found = {name: diagnosis(cause("mass", "mass", value, 0.2, 90.0)) for name, value in values.items()}
    found["c"].causes[0].parameters["mass"].identifiable = False
    members = [Member(name=name, boat="one", dataset=name) for name in found]
    ((drift,), _) = changes_of(members, found, findings_of(members, found)[0])
    assert drift.values == {"a": 60.0, "b": 65.0}


@pytest.mark.parametrize(
    ("values", "errors", "drifts"),
    [((1.0, 2.0), (1e-200, 1e-200), 1), ((1e308, -1e308), (1.0, 1.0), 0), ((1.0, 2.0), (1e-155, 1.0), 0)],
)
def test_parameters_at_the_end_of_floating_point_end_no_fleet(
    values: tuple[float, float], errors: tuple[float, float], drifts: int
) -> None:
    members = [Member(name=name, boat="one", dataset=name) for name in ("a", "b")]
    found = {
        name: diagnosis(cause("mass", "mass", value, error, 90.0))
        for name, value, error in zip("ab", values, errors, strict=True)
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result, _ = changes_of(members, found, findings_of(members, found)[0])
    assert len(result) == drifts


def test_a_cause_of_some_days_is_reported_and_equal_days_do_not_differ() -> None:
    found = {
        "a": diagnosis(cause("mass", "mass", 60.0, 1.0, 90.0)),
        "b": diagnosis(cause("mass", "mass", 60.5, 1.0, 90.0)),
        "c": diagnosis(),
    }
    members = [Member(name=name, boat="one", dataset=name) for name in found]
    findings, _ = findings_of(members, found)
    drifts, changes = changes_of(members, found, findings)
    assert drifts == []
    assert [(one.cause, one.found_in, one.absent_in) for one in changes] == [("mass", ["a", "b"], ["c"])]


def test_angles_are_compared_the_short_way_round() -> None:
    assert heterogeneity([3.1, -3.1], [0.1, 0.1], angle=True) == pytest.approx(
        (2.0 * math.pi - 6.2) ** 2 / 0.02
    )
    assert heterogeneity([3.1, -3.1], [0.1, 0.1]) == pytest.approx(6.2**2 / 0.02)


def test_a_cause_that_is_minor_on_another_day_is_not_absent_and_its_estimates_are_compared() -> None:
    drifts, changes = of_one_boat({"a": diagnosis(mass(40.0)), "b": diagnosis(minor=[mass(40.5)])})
    assert (drifts, changes) == ([], [])
    drifts, changes = of_one_boat({"a": diagnosis(mass(40.0)), "b": diagnosis(minor=[mass(49.0)])})
    assert [one.values for one in drifts] == [{"a": 40.0, "b": 49.0}] and changes == []


def test_a_cause_below_the_false_discovery_rate_is_neither_found_nor_absent() -> None:
    weak = cause("mass", "mass", 40.0, 1.0, 2.0)
    assert of_one_boat({"a": diagnosis(mass()), "b": diagnosis(weak)}) == ([], [])


def test_a_cause_is_not_absent_where_only_its_equivalent_was_found() -> None:
    drag = cause("linear_drag", "scale", 1.5, 0.1, 90.0)
    resistance = cause("resistance", "scale", 1.5, 0.1, 90.0)
    equal = [["current by_run + resistance", "current by_run + linear_drag"]]
    unsure = diagnosis(current(), resistance, indistinguishable=equal)
    assert of_one_boat({"a": unsure, "b": diagnosis(drag)})[1] == []
    assert of_one_boat({"a": diagnosis(drag), "b": unsure})[1] == []
    (change,) = of_one_boat({"a": unsure, "b": diagnosis(current())})[1]
    assert (change.cause, change.found_in, change.absent_in) == ("resistance", ["a"], ["b"])


def test_weather_is_neither_a_shared_cause_nor_a_change_of_a_boat() -> None:
    found = {"a": diagnosis(current(), mass()), "b": diagnosis(mass()), "c": diagnosis(current())}
    members = [Member(name=name, boat=name, dataset=name) for name in found]
    findings, _ = findings_of(members, found)
    assert [(one.cause, one.boats) for one in shared_causes(findings)] == [("mass", ["a", "b"])]
    assert [(one.cause, one.boats) for one in weather_of(findings)] == [("current", ["a", "c"])]
    assert of_one_boat({"a": diagnosis(current()), "b": diagnosis()}) == ([], [])
