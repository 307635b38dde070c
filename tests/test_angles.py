"""Angles brought back into one turn, and plane vectors turned by an angle."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.angles import turned, within_half_turn, wrapped, wrapped_below

finite = st.floats(-100.0, 100.0)
half_turns = st.builds(
    lambda odd, last_bits: odd * math.pi + last_bits * math.ulp(math.pi),
    st.sampled_from([-3, -1, 1, 3]),
    st.integers(-2, 2),
)
angles = st.one_of(finite, half_turns)


def is_congruent(one: float, other: float) -> bool:
    """Whether two angles [rad] have the same sine and cosine."""
    return math.hypot(math.cos(one) - math.cos(other), math.sin(one) - math.sin(other)) < 1e-13


@given(angle=angles)
def test_a_wrapped_angle_is_the_same_direction_above_minus_pi_and_up_to_pi(angle: float) -> None:
    found = wrapped(angle)
    assert -math.pi < found <= math.pi
    assert is_congruent(found, angle)
    assert wrapped(np.array([angle])).tolist() == [found]


@given(angle=angles)
def test_an_angle_wrapped_below_is_the_same_direction_from_minus_pi_and_below_pi(angle: float) -> None:
    found = wrapped_below(angle)
    assert -math.pi <= found < math.pi
    assert is_congruent(found, angle)
    assert wrapped_below(np.array([angle])).tolist() == [found]


@given(angle=angles)
def test_an_angle_within_half_a_turn_is_the_same_direction_and_left_alone_there(angle: float) -> None:
    found = float(within_half_turn(np.array([angle]))[0])
    assert -math.pi <= found <= math.pi
    assert is_congruent(found, angle)
    if -math.pi <= angle <= math.pi:
        assert found == angle


def test_the_first_angle_beyond_half_a_turn_is_half_a_turn() -> None:
    beyond = math.nextafter(math.pi, 4.0)
    assert wrapped(beyond) == math.pi
    assert wrapped_below(-beyond) == -math.pi


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
