"""How numbers are written."""

import math

import pytest

from swamp_rl.html_page import with_error


@pytest.mark.parametrize(
    ("value", "error", "said"),
    [
        (0.3195, 0.0025, "0.3195 ± 0.0025"),
        (0.1, 0.0123, "0.100 ± 0.012"),
        (0.5, 0.0, "0.50 ± 0.00"),
        (0.5, math.inf, "0.50 ± inf"),
    ],
)
def test_a_number_has_as_many_decimals_as_its_standard_error(value: float, error: float, said: str) -> None:
    assert with_error(value, error) == f"{said} (one standard error)"
