"""Predictions of the pond tests against what was measured."""

import numpy as np
import pytest

from benchmarks.esso_osaka.circles import circle
from benchmarks.esso_osaka.pond import BOAT, DATA, pond
from benchmarks.esso_osaka.pond_tests import window_errors

on_the_pond = pytest.mark.skipif(not DATA.is_dir(), reason="the pond data are not beside this checkout")


@on_the_pond
def test_half_a_minute_is_predicted_better_than_by_the_independent_program() -> None:
    runs = [pond(f"random/{path.name}") for path in sorted((DATA / "random").glob("*.csv"))]
    calm, windy = (window_errors(BOAT, runs, 30.0, measured) for measured in (False, True))
    assert len(calm) == 138
    assert np.sqrt(np.mean(windy**2)) < 0.47  # that program: 0.47 m with Fujiwara's wind coefficients
    assert np.sqrt(np.mean(calm**2)) < 0.75
    assert np.sqrt(np.mean(windy**2)) < 0.6 * np.sqrt(np.mean(calm**2))


@on_the_pond
def test_circles_are_ahead_as_measured_but_wider_as_the_document_says() -> None:
    measured, windy, _ = circle(BOAT, pond("turning/turn_14-Sep-2020_14_50_41.csv"))
    assert windy.advance == pytest.approx(measured.advance, rel=0.15)
    assert 1.2 < windy.tactical_diameter / measured.tactical_diameter < 1.6
