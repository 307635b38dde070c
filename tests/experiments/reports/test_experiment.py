"""The report of an experiment states what was asked and counted, on any course."""

from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure
from swamp_rl.experiments.reports.experiment import failures, success, targets_reached, training_data
from swamp_rl.experiments.reports.figures import success_rates


def results(pilots: dict[str, float]) -> dict[str, Any]:
    """The part of results.json that success rates are read from."""
    levels = {"calm": {}}
    rates = {
        name: {"levels": {"calm": {"success_rate": rate, "wilson_95": [rate, rate]}}}
        for name, rate in pilots.items()
    }
    return {"evaluation": {"levels": levels}, "pilots": rates}


@pytest.mark.parametrize(("targets", "named"), [({}, ["ppo"]), ({"ppo": {"calm": 0.9}}, ["target", "ppo"])])
def test_the_figure_of_success_names_a_target_only_where_one_is_set(
    targets: dict[str, dict[str, float]], named: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    rates = {name: one["levels"] for name, one in results({"ppo": 0.5})["pilots"].items()}
    success_rates(tmp_path / "success.png", rates, targets, "Success")
    assert [text.get_text() for text in drawn[0].axes[0].get_legend().get_texts()] == named


def test_success_is_defined_for_any_number_of_gates() -> None:
    text = success(results({"ppo": 0.5}))
    assert "All gates passed" in text and "oth gates" not in text
    assert "| ppo | 50.0 (50.0–50.0) |" in text


@pytest.mark.parametrize(
    ("reached", "message"),
    [
        ([], "sets no targets"),
        ([True, False], "Targets reached: 1 of 2."),
        ([True], "Targets reached: 1 of 1."),
    ],
)
def test_targets_are_counted_only_where_some_are_set(reached: list[bool], message: str) -> None:
    text = targets_reached([{"reached": one} for one in reached])
    assert message in text and "0 of 0" not in text


def test_failures_are_counted_by_how_they_ended_the_most_first() -> None:
    result = results({"ppo": 0.4, "sac": 1.0})
    ends = {"ppo": {"success": 4, "buoy": 1, "out_of_bounds": 5}, "sac": {"success": 10}}
    for name, outcomes in ends.items():
        result["pilots"][name]["levels"]["calm"]["outcomes"] = outcomes
    text = failures(result)
    assert "| ppo | 5 out of bounds, 1 buoy |" in text and "| sac | none |" in text


def test_runs_that_did_not_succeed_are_counted_by_how_they_ended() -> None:
    result = results({"ppo": 0.4})
    result["pilots"]["ppo"]["learned_from"] = ""
    ends = {"success": 21, "buoy": 3, "interrupted": 2, "out_of_bounds": 1}
    result["data"] = {"runs": 27, "successful": 21, "outcomes": ends, "notes": [], "trained_on": True}
    text = training_data(result)
    assert (
        "27 runs, 21 of them successful; outcomes of the others: 3 buoy, 2 interrupted, 1 out of bounds."
        in text
    )
    result["data"] |= {"runs": 1, "successful": 1, "outcomes": {"success": 1}}
    assert "1 run, 1 of them successful; outcomes of the others: none." in training_data(result)
