"""What differs between runs or days in a diagnosis, drawn as for another one."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.config.posterior import write_posterior

from swamp_rl.boat import load_boat
from swamp_rl.effects import load_disturbances
from swamp_rl.simulator import parameters
from tests.support.diagnosis_file import CURRENT, WEAK, diagnosis, estimate

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")


def test_a_wind_that_differs_between_runs_is_drawn_for_another_run(tmp_path: Path) -> None:
    north, east, sure, spread = -1.0, 2.0, 0.1, 1.5
    cause = {
        "effect": "wind",
        "parameters": {
            "speed": estimate(float(np.hypot(north, east)), sure, "m/s"),
            "from": estimate(float(np.arctan2(east, north)), sure / np.hypot(north, east), "rad"),
        },
        "scope": "run",
        "spread": {
            name: {"value": spread, "low": 0.5, "high": 4.0, "unit": "m/s"} for name in ("north", "east")
        },
    }
    matrix = (0.5 * np.eye(4) + 0.5).tolist()
    write_posterior(diagnosis(tmp_path, cause, CURRENT, correlation=matrix), tmp_path / "found.yaml")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 20_000)
    level.apply(record, np.random.default_rng(0).random((20_000, level.draw_count)))
    for part, mean in ((np.cos, north), (np.sin, east)):
        drawn = record["wind_speed"] * part(record["wind_from"])
        assert drawn.mean() == pytest.approx(mean, abs=0.05)
        assert drawn.std() == pytest.approx(np.hypot(spread, sure), rel=0.03)
    assert np.corrcoef(record["current_north"], record["current_east"])[0, 1] == pytest.approx(0.5, abs=0.03)


def test_a_current_that_differs_between_runs_is_as_wide_as_these_differ(tmp_path: Path) -> None:
    spread = {name: {"value": 0.4, "low": 0.1, "high": 1.0, "unit": "m/s"} for name in ("north", "east")}
    level = write_posterior(
        diagnosis(tmp_path, CURRENT | {"scope": "run", "spread": spread}), tmp_path / "found.yaml"
    )
    assert level["effects"][0]["north"]["normal"][:2] == pytest.approx([0.2, np.hypot(0.02, 0.4)])


def test_a_load_that_differs_between_two_days_is_drawn_as_wide_as_these_and_by_itself(tmp_path: Path) -> None:
    between, of_mean, t = 4.95, 3.5, 12.706 / 1.96  # kg, kg, Student's t of one degree of freedom
    load = {
        "effect": "mass",
        "parameters": {"mass": estimate(52.5, of_mean * t, "kg")},
        "scope": "day",
        "groups": {day: {"mass": estimate(mass, 0.1, "kg")} for day, mass in (("may", 49.0), ("june", 56.0))},
        "spread": {"mass": {"value": between, "low": 1.9, "high": 55.0, "unit": "kg"}},
    }
    found = diagnosis(tmp_path, WEAK, load, correlation=[[1.0, 0.8], [0.8, 1.0]])
    level = write_posterior(found, tmp_path / "found.yaml")
    mean, deviation, *_ = level["effects"][1]["mass"]["normal"]
    assert (mean, deviation) == (52.5, pytest.approx(np.hypot(between, of_mean), rel=1e-3))
    assert "correlated" not in level
