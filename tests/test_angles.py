"""Plane vectors turned by an angle."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.angles import turned

finite = st.floats(-100.0, 100.0)


@given(ahead=finite, starboard=finite, heading=st.floats(-10.0, 10.0))
def test_turning_by_the_heading_and_back_leaves_a_vector_as_it_was(
    ahead: float, starboard: float, heading: float
) -> None:
    there = turned(ahead, starboard, heading)
    by_complex = complex(ahead, starboard) * complex(math.cos(heading), math.sin(heading))
    assert there == pytest.approx((by_complex.real, by_complex.imag), abs=1e-9)
    assert turned(*there, -heading) == pytest.approx((ahead, starboard), abs=1e-9)


def test_ahead_of_a_boat_that_heads_east_is_east_and_its_starboard_is_south() -> None:
    assert turned(1.0, 0.0, math.pi / 2) == pytest.approx((0.0, 1.0))
    assert turned(0.0, 1.0, math.pi / 2) == pytest.approx((-1.0, 0.0))
