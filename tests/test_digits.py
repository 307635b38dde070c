"""Numbers of reports have the digits that are known."""

import math

import pytest

from swamp_rl.digits import digits, known


@pytest.mark.parametrize(
    ("value", "error", "count", "shown"),
    [
        (1.2792, 0.049, 4, "1.279"),
        (-8.7e-8, 6.7e-5, 4, "0"),
        (14700.0, 5880.0, 4, "14700"),
        (3.0, math.inf, 4, "3"),
        (0.600149, 0.00027, 6, "0.60015"),
        (64.96, 0.2, 6, "64.96"),
    ],
)
def test_a_number_is_shown_to_the_second_digit_of_its_standard_error(
    value: float, error: float, count: int, shown: str
) -> None:
    assert known(value, error, count) == shown


def test_numbers_up_to_a_million_have_no_exponent() -> None:
    assert [digits(value, 2) for value in (60000.0, 0.0123, 2.5e7)] == ["60000", "0.012", "2.5e+07"]
