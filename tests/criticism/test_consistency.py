"""Columns that contradict each other are refused by name before anything is fitted to them."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.errors import UserError
from tests.support.criticism import DT, simulated_runs

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


def weaving(sideways: float, seed: int = 0) -> RunSet:
    """Runs without velocities of a boat that weaves about many courses, its bow so far off them [rad]."""
    rng, runs = np.random.default_rng(seed), simulated_runs([], velocities=False)
    seconds = DT * np.arange(runs.measured.shape[1])
    heading = 0.15 * seconds + 0.4 * np.sin(0.5 * seconds) + rng.uniform(-3.0, 3.0, 3)[:, None]
    measured = runs.measured.copy()
    measured[..., 0] = DT * np.cumsum(np.cos(heading + sideways), axis=1)
    measured[..., 1] = DT * np.cumsum(np.sin(heading + sideways), axis=1)
    measured[..., 2], measured[..., 5] = heading, 0.15 + 0.2 * np.cos(0.5 * seconds)
    return replace(runs, measured=measured + 0.01 * rng.standard_normal(measured.shape))


@pytest.mark.parametrize("sideways", [0.0, 0.5, np.pi / 2, np.pi])
def test_mirrored_positions_and_headings_are_named_without_velocities(sideways: float) -> None:
    runs = weaving(sideways)
    refuse_inconsistent(runs, "folder")
    turned = runs.measured.copy()
    turned[..., 2], turned[..., 5] = -turned[..., 2], -turned[..., 5]
    for message, other in (
        ("north and east look swapped", runs.measured[..., [1, 0, 2, 3, 4, 5]]),
        ("heading looks anticlockwise", turned),
    ):
        with pytest.raises(UserError, match="look" if sideways % np.pi else message):
            refuse_inconsistent(replace(runs, measured=other), "folder")


def test_a_boat_that_drifts_with_its_bow_held_is_not_one_of_swapped_axes() -> None:
    runs = weaving(0.0)
    drifting = runs.measured.copy()
    drifting[..., 2] = 0.1 * np.sin(DT * np.arange(drifting.shape[1]))
    drifting[..., 5] = np.nan
    for course in (0.0, 0.8, np.pi / 2):
        drifting[..., 0] = 0.3 * DT * np.arange(drifting.shape[1]) * np.cos(course)
        drifting[..., 1] = 0.3 * DT * np.arange(drifting.shape[1]) * np.sin(course)
        refuse_inconsistent(replace(runs, measured=drifting), "folder")


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
