"""Propeller models: the bladed disc, its linear form, four quadrants, cross flow, and the motor."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.design.propellers import (
    advance_angle,
    crossflow_factor,
    disc_speed_increase,
    disc_thrust,
    disc_thrust_coefficient,
    four_quadrant_thrust,
    fourier_series,
    linear_four_quadrant,
    linear_thrust,
    linear_thrust_coefficient,
    modified_coefficient,
    motor_torque,
)

DENSITY, DIAMETER = 1025.0, 0.12


@pytest.mark.parametrize(("ratio", "known"), [(0.8, 0.399), (1.0, 0.559), (1.2, 0.714), (1.4, 0.858)])
def test_the_bladed_discs_bollard_coefficients_are_an_independent_programs(
    ratio: float, known: float
) -> None:
    assert float(disc_thrust_coefficient(0.0, ratio)) == pytest.approx(known, abs=5e-4)


@given(ratio=st.floats(0.3, 3.0), share=st.floats(0.0, 1.0))
def test_the_bladed_disc_conserves_rothalpy_and_falls_to_nothing_at_the_pitch(
    ratio: float, share: float
) -> None:
    j, tangent = share * ratio, ratio / math.pi
    increase = float(disc_speed_increase(j, ratio))
    # (14) with similar triangles at unit n d: w_1² = J² + π², w_2 axial speed J + Δ/2 along the blade
    leaving = (j + 0.5 * increase) ** 2 * (1.0 + 1.0 / tangent**2)
    entering = j**2 + math.pi**2
    assert entering - leaving == pytest.approx(
        2.0 * j * increase + increase**2 - (j + 0.5 * increase) ** 2 + j**2, abs=1e-6
    )
    assert float(disc_thrust_coefficient(ratio, ratio)) == pytest.approx(0.0, abs=1e-9)


def test_the_uniform_discs_thrust_is_the_momentum_that_it_gives() -> None:
    area, inflow, increase = math.pi * DIAMETER**2 / 4.0, 1.5, 0.8
    momentum = DENSITY * area * (inflow + 0.5 * increase) * increase
    assert float(disc_thrust(DENSITY, DIAMETER, inflow, increase)) == pytest.approx(momentum)


def test_the_linear_thrust_is_the_linear_coefficients() -> None:
    n, v, bollard, ratio, factor = 20.0, 1.1, 0.5, 1.2, 0.95
    coefficient = linear_thrust_coefficient(v / (n * DIAMETER), bollard, ratio, factor)
    expected = float(coefficient) * DENSITY * n**2 * DIAMETER**4
    found = linear_thrust(DENSITY, DIAMETER, n, v, bollard, factor * ratio)
    assert float(found) == pytest.approx(expected)


def test_the_modified_coefficient_gives_the_same_thrust() -> None:
    n, v, k_t = 15.0, 0.9, 0.3
    star = modified_coefficient(k_t, v / (n * DIAMETER))
    thrust = four_quadrant_thrust(DENSITY, DIAMETER, n, v, star)
    assert float(thrust) == pytest.approx(k_t * DENSITY * n**2 * DIAMETER**4)


def test_the_advance_angle_tells_all_four_quadrants() -> None:
    found = np.degrees(advance_angle([10.0, -10.0, -10.0, 10.0, 0.0], [1.0, 1.0, -1.0, -1.0, 1.0], DIAMETER))
    assert [math.floor(angle / 90.0) for angle in found[:4]] == [0, 1, -2, -1]
    assert found[4] == pytest.approx(90.0)


def test_a_fourier_series_is_periodic_and_its_first_terms_are_cosine_and_sine() -> None:
    angle = np.linspace(-math.pi, math.pi, 7)
    found = fourier_series(angle, [0.5, 2.0], [0.0, 3.0])
    assert found == pytest.approx(0.5 + 2.0 * np.cos(angle) + 3.0 * np.sin(angle))
    assert fourier_series(angle + 2.0 * math.pi, [0.5, 2.0], [0.0, 3.0]) == pytest.approx(found)


@given(n=st.floats(-50.0, 50.0), v=st.floats(-3.0, 3.0))
def test_a_symmetric_propeller_pushes_alike_both_ways(n: float, v: float) -> None:
    ahead = float(linear_four_quadrant(DENSITY, DIAMETER, n, v, 0.4, 1.0))
    astern = float(linear_four_quadrant(DENSITY, DIAMETER, -n, -v, 0.4, 1.0))
    assert ahead == pytest.approx(-astern)
    if n > 0.0:
        assert ahead == pytest.approx(float(linear_thrust(DENSITY, DIAMETER, n, v, 0.4, 1.0)))


def test_flow_across_takes_thrust_the_more_the_faster_and_by_the_ratio_alone() -> None:
    factors = crossflow_factor([0.0, 0.5, 1.0, 2.0], 2.0, 0.7)
    assert factors[0] == 1.0
    assert np.all(np.diff(factors) < 0.0)
    assert crossflow_factor(1.0, 2.0, 0.7) == pytest.approx(crossflow_factor(3.0, 6.0, 0.7))


def test_the_motors_torque_falls_from_stall_to_nothing() -> None:
    stall, nominal, at, most = 1.13, 0.0631, 1750.0, 1800.0
    found = motor_torque([0.0, at, most, 2.0 * most], stall, nominal, at, most)
    assert found == pytest.approx([stall, nominal, 0.0, 0.0])
    between = motor_torque(np.linspace(0.0, most, 50), stall, nominal, at, most)
    assert np.all(np.diff(between) < 0.0)
