"""Columns that contradict each other are refused by name before anything is fitted to them."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.errors import UserError
from tests.support.criticism import simulated_runs

pytestmark = pytest.mark.numerical


@pytest.mark.parametrize("velocities", [True, False])
def test_consistent_columns_pass_even_with_a_sensor_fault_of_a_usual_size(velocities: bool) -> None:
    refuse_inconsistent(simulated_runs([], velocities=velocities), "folder")
    for effect in (
        {"effect": "heading_bias", "bias": 0.15},
        {"effect": "position_delay", "delay": 0.75},
        {"effect": "position_lever_arm", "x": 0.5, "y": -0.3},
    ):
        refuse_inconsistent(simulated_runs([effect], velocities=velocities), "folder")


@pytest.mark.parametrize(
    ("message", "columns"),
    [
        ("north and east look swapped", [1, 0, 2, 3, 4, 5]),
        ("surge and sway look swapped", [0, 1, 2, 4, 3, 5]),
    ],
)
def test_swapped_columns_are_named(message: str, columns: list[int]) -> None:
    found = simulated_runs([])
    with pytest.raises(UserError, match=message):
        refuse_inconsistent(replace(found, measured=found.measured[..., columns]), "folder")


def test_a_turned_heading_and_yaw_rates_in_degrees_or_late_are_named() -> None:
    found = simulated_runs([])
    measured = found.measured
    for result, column, values in (
        ("heading looks measured from east", 2, np.pi / 2 - measured[..., 2]),
        (
            "yaw_rate looks like degrees a second against the heading; correct",
            5,
            np.degrees(measured[..., 5]),
        ),
        ("yaw_rate looks positive to port against the heading; correct", 5, -measured[..., 5]),
        ("yaw_rate is 0.8 s late", 5, np.roll(measured[..., 5], 8, axis=1)),
    ):
        other = measured.copy()
        other[..., column] = values
        if column == 2:
            other[..., 5] = -other[..., 5]
        with pytest.raises(UserError, match=result):
            refuse_inconsistent(replace(found, measured=other), "folder")
