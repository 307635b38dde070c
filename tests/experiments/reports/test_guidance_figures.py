"""Axes of the figures of `follow` and `hold`."""

import pytest
from matplotlib.figure import Figure
from swamp_rl.experiments.reports.guidance_figures import reach_at_least


@pytest.mark.parametrize("size", [0.0, 1e-11, 0.5])
def test_an_axis_of_rounding_errors_reaches_as_far_as_errors_that_matter(size: float) -> None:
    axes = Figure().subplots()
    axes.plot([0.0, 1.0], [-size, size])
    reach_at_least(axes, 1.0)
    low, high = axes.get_ylim()
    assert -1.2 < low <= -1.0 and 1.0 <= high < 1.2


def test_an_axis_of_errors_that_matter_stays_as_it_was() -> None:
    axes = Figure().subplots()
    axes.plot([0.0, 1.0], [-3.0, 5.0])
    before = axes.get_ylim()
    reach_at_least(axes, 1.0)
    assert axes.get_ylim() == pytest.approx(before)
