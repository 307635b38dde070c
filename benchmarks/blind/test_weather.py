"""The table of level E: rates, coverage of the runs' weather, and what is over a bar."""

from typing import Any

import pytest

from benchmarks.blind.score import judged
from benchmarks.blind.tables import parts
from benchmarks.blind.weather import weather_table

TRUTH = {
    "level": "E",
    "kind": "pair",
    "effects": [{"effect": "mass", "mass": 64.0}],
    "size": 1.0,
    "outside": None,
    "hull": {},
    "by_run": [
        [{"effect": "wind", "speed": 4.0, "from": 3.1}],
        [{"effect": "wind", "speed": 2.0, "from": 0.0}],
    ],
}


def number(value: float, error: float, unit: str) -> dict[str, Any]:
    return {"value": value, "standard_error": error, "unit": unit}


def answer() -> dict[str, Any]:
    winds = {
        "run_0": {"speed": number(4.1, 0.1, "m/s"), "from": number(-3.1, 0.1, "rad")},
        "run_1": {"speed": number(2.5, 0.1, "m/s"), "from": number(0.0, 0.1, "rad")},
    }
    mass = {"effect": "mass", "thruster": None, "parameters": {"mass": number(64.5, 0.5, "kg")}, "groups": {}}
    wind = {"effect": "wind", "thruster": None, "parameters": {}, "groups": winds}
    return {"verdict": "cause", "causes": [mass, wind], "indistinguishable": [], "elapsed_s": 9.0}


def scored() -> dict[str, Any]:
    return judged(TRUTH, answer()) | {"case": "E0001", "processor_s": 20.0}


def test_each_runs_wind_is_held_against_its_truth_in_standard_errors() -> None:
    away = [one["away"] for one in scored()["run_estimates"]]
    assert away == pytest.approx([1.0, 0.8318, 5.0, 0.0], abs=1e-3)  # -3.1 is 0.083 beyond 3.1


def test_the_table_tells_rates_counts_and_bars() -> None:
    message = weather_table([scored(), scored() | {"kind": "single", "alone": False, "processor_s": 70.0}])
    assert "| cases | 2 |" in message
    assert "| wind or current alone, identified | 0.000" in message and "0.97: missed" in message
    assert "1.000 (0.21 to 1.00; 1) | 0.95: reached" in message
    assert "0.750 (0.41 to 0.93; 8) | 0.93 to 0.97: missed" in message
    assert "| processor s, longest | 70 | 60 s: missed |" in message


def test_level_e_has_a_table_of_its_own_and_leaves_the_others_as_they_are() -> None:
    assert set(parts([scored()])) == {"blind weather"}
