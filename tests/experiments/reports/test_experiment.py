"""The report of an experiment states what was asked and counted, on any course."""

from typing import Any

import pytest
from swamp_rl.experiments.reports.experiment import failures, success, targets_reached


def results(pilots: dict[str, float]) -> dict[str, Any]:
    """The part of results.json that success rates are read from."""
    levels = {"calm": {}}
    rates = {
        name: {"levels": {"calm": {"success_rate": rate, "wilson_95": [rate, rate]}}}
        for name, rate in pilots.items()
    }
    return {"evaluation": {"levels": levels}, "pilots": rates}


def test_success_is_defined_for_any_number_of_gates() -> None:
    text = success(results({"ppo": 0.5}))
    assert "All gates passed" in text and "oth gates" not in text
    assert "| ppo | 50.0 (50.0–50.0) |" in text


@pytest.mark.parametrize(
    ("reached", "said"),
    [([], "sets no targets"), ([True, False], "1 of 2 targets were reached"), ([True], "1 of 1 targets")],
)
def test_targets_are_counted_only_where_some_are_set(reached: list[bool], said: str) -> None:
    text = targets_reached([{"reached": one} for one in reached])
    assert said in text and "0 of 0" not in text


def test_failures_are_counted_by_how_they_ended_the_most_first() -> None:
    told = results({"ppo": 0.4, "sac": 1.0})
    ends = {"ppo": {"success": 4, "buoy": 1, "out_of_bounds": 5}, "sac": {"success": 10}}
    for name, outcomes in ends.items():
        told["pilots"][name]["levels"]["calm"]["outcomes"] = outcomes
    text = failures(told)
    assert "| ppo | 5 out of bounds, 1 buoy |" in text and "| sac | none |" in text
