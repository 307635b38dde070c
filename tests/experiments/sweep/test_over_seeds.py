"""Trials that differ only in a seed are taken together."""

from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.sweep.over_seeds import over_seeds
from swamp_rl.experiments.sweep.report import write_report
from swamp_rl.experiments.sweep.store import Trial

from tests.support.sweeps import sweep_of

RATES = {10: (1.0, 0.25), 40: (0.9, 0.8)}
"""Success of two seeds, by units."""
PARAMETERS = {"net.units": {"grid": [10, 40]}, "net.seed": {"grid": [0, 1]}}


def tried(**more: Any) -> list[dict[str, Any]]:
    found = []
    for units, rates in RATES.items():
        for seed, rate in enumerate(rates):
            values = {"net.units": units, "net.seed": seed}
            found.append({"values": values, "value": rate, "summary": {"success_rate": rate}} | more)
    return found


def test_the_setting_of_the_best_mean_comes_first_though_another_has_the_best_trial() -> None:
    found = over_seeds(sweep_of(parameters=PARAMETERS), tried())
    assert [one["values"] for one in found] == [{"net.units": 40}, {"net.units": 10}]
    assert found[0]["success"] == pytest.approx({"mean": 0.85, "least": 0.8, "greatest": 0.9})
    assert [one["seeds"] for one in found] == [2, 2]


def test_trials_that_failed_or_never_succeeded_are_no_values() -> None:
    cost = {"pilot": "net", "level": "calm", "measure": "time"}
    sweep = sweep_of(parameters=PARAMETERS, objective=cost)
    assert [one["value"] for one in over_seeds(sweep, tried(value=None))] == [None, None]
    assert over_seeds(sweep, tried(summary=None)) == []


@pytest.mark.parametrize("only", ["net.units", "net.seed"])
def test_one_kind_of_parameter_alone_has_nothing_to_take_together(only: str) -> None:
    assert over_seeds(sweep_of(parameters={only: PARAMETERS[only]}), tried()) == []


def test_trials_of_different_settings_are_listed_once_as_trials() -> None:
    assert over_seeds(sweep_of(parameters=PARAMETERS), tried()[1:3]) == []


def test_the_page_lists_the_means(tmp_path: Path) -> None:
    trials = {}
    for number, one in enumerate(tried()):
        summary = one["summary"] | {"wilson_95": [0.0, 1.0]}
        trials[number] = Trial(number, one["values"], one["value"], summary, None, 1, 1.0)
    write_report(tmp_path, sweep_of(parameters=PARAMETERS), [], trials)
    assert "| 40 | 2 | 85.0 (80.0 to 90.0) |" in (tmp_path / "sweep.md").read_text()
