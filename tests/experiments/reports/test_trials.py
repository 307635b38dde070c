"""The cells of a trial report name each number beside a value."""

import pytest
from swamp_rl.experiments.reports.trials import cell

from swamp_rl.manoeuvres.analysis.figure import Figure


@pytest.mark.parametrize(
    ("figure", "text"),
    [
        (Figure(10.0, "deg", (9.0, 11.0), 9.0, 11.0), "10.00 [9.00, 11.00], sd 1.41"),
        (Figure(10.0, "deg", (9.0, 11.0), 10.0001, 10.0002), "10.00, sd 1.41"),  # an interval without width
        (Figure(5.0, "m", low=4.0, high=6.0), "2.50 [2.00, 3.00]"),
        (Figure(float("nan"), "m"), "–"),
        (None, "–"),
    ],
)
def test_a_cell_holds_the_value_its_interval_and_its_standard_deviation(figure: Figure, text: str) -> None:
    assert cell(figure, length=2.0) == text
