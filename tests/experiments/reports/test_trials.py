"""The tables of a trial report: each number beside a value, and the names of runs."""

import pytest
from swamp_rl.experiments.reports.trials import cell, imo_table

from swamp_rl.manoeuvres.analysis.figure import Figure, Result
from swamp_rl.manoeuvres.analysis.imo import Criterion


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


def test_the_name_of_a_run_is_text_in_the_table_of_limits() -> None:
    criteria = [Criterion("advance", 4.0, 4.5, "L")]
    row = imo_table([Result("a|<img src=x>", "turning-circle", {}, criteria=criteria)]).splitlines()[-1]
    assert row == r"| a\|\<img src=x\> | advance | 4.00 L | 4.50 | pass |"
