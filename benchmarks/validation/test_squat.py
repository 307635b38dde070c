"""Squat by formula: near the tank's where ground is near, on the safe side at low speed."""

import pytest

from benchmarks.validation.squat import SQUAT, ratios


@pytest.mark.parametrize("depth", [0.21, 0.28, 0.35])
def test_at_the_highest_speeds_of_shallow_water_the_formula_is_near_the_tank(depth: float) -> None:
    assert ratios(depth)[-1] == pytest.approx(1.0, abs=0.16)


@pytest.mark.parametrize("depth", [0.21, 0.28, 0.35])
def test_at_lower_speeds_it_is_on_the_safe_side(depth: float) -> None:
    assert len(ratios(depth)) == len(SQUAT[depth]) and ratios(depth)[:-1].min() > 1.0
