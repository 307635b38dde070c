"""The costs of an episode, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.evaluation.metrics import bollard_thrust, command_change, jet_areas, jet_power, path_length


def test_path_length_of_a_quarter_circle_is_half_pi_radius() -> None:
    angle = np.linspace(0.0, np.pi / 2, 2000)
    pose = np.stack([3 * np.cos(angle), 3 * np.sin(angle), angle], axis=-1)
    assert path_length(pose) == pytest.approx(1.5 * np.pi, rel=1e-6)


def test_path_length_of_a_batch_is_that_of_each_run() -> None:
    poses = np.random.default_rng(0).normal(size=(4, 30, 3))
    assert path_length(poses) == pytest.approx([path_length(pose) for pose in poses])


def test_a_lever_thrown_from_end_to_end_each_step_changes_by_its_whole_travel() -> None:
    angle = np.where(np.arange(50) % 2, 1.0, -1.0)
    assert command_change(np.stack([np.ones(50), angle], axis=-1)) == pytest.approx(2.0)


def test_constant_commands_change_nothing() -> None:
    assert command_change(np.full((7, 40, 2), 0.3)) == pytest.approx(np.zeros(7))
    assert command_change(np.full((1, 2), 0.3)) == 0.0


@given(st.floats(0.01, 100), st.floats(900, 1100))
def test_jet_power_is_half_the_mass_flow_times_the_jet_speed_squared(thrust: float, density: float) -> None:
    area = 900e-6
    speed = np.sqrt(thrust / (density * area))
    assert jet_power(np.array(thrust), density, area) == pytest.approx(0.5 * density * area * speed**3)


def test_a_jet_is_as_wide_as_its_nozzle_and_a_propellers_wake_as_half_its_disc() -> None:
    ship = load_boat("esso_osaka")
    assert jet_areas(load_boat("swamp")).tolist() == [900e-6] * 4
    # A disc at rest takes in the water at half the speed at which it leaves it.
    diameter, thrust = ship.thrusters[0].propeller.diameter, 10.0
    through = math.sqrt(thrust / (2.0 * 1000.0 * 0.25 * math.pi * diameter**2))
    power = jet_power(np.array(thrust), 1000.0, jet_areas(ship)[0])
    assert power == pytest.approx(thrust * through)


def test_a_thruster_without_a_jet_in_the_file_is_taken_as_a_propeller_of_the_boats_own_size() -> None:
    model = {"nozzle_area": None, "advance_loss": None}
    small, large = (load_boat("swamp", {"thruster_model": model, "draught": d}) for d in (0.14, 0.28))
    disc = 0.25 * math.pi * (0.7 * 0.14) ** 2
    assert jet_areas(small) == pytest.approx([0.5 * disc] * 4)
    assert jet_areas(large) == pytest.approx([2.0 * disc] * 4)


def test_jet_power_is_a_plausible_part_of_the_measured_motor_power() -> None:
    # 96.7 W at 12.3 N were measured; motor 0.85, bearings 0.95, then a pump and nozzle of 20 to 60 %
    assert 0.2 * 0.85 * 0.95 * 96.7 < jet_power(np.array(12.3), 1000.0, 900e-6) < 0.6 * 0.85 * 0.95 * 96.7


def test_bollard_thrust_agrees_with_table_5_5() -> None:
    percent, newton = np.array([50.0, 70.0, 85.0, 100.0]), [3.1, 6.0, 8.8, 12.2]
    thrust = bollard_thrust(percent[:, None] / 100, np.zeros(1), np.full(1, 12.2))
    assert thrust[:, 0] == pytest.approx(newton, abs=0.06)
