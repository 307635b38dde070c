"""Passing, touching and leaving, against closed forms and symmetries."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from swamp_rl.course.geometry import crosses_gate, outside, squared_distance_to_way, touches_buoy
from swamp_rl.course.progress import ACROSS, distance_to_gate, distance_to_go

HALF_WIDTH = 2.0
place = st.floats(-20.0, 20.0)
angle = st.floats(-math.pi, math.pi)


def in_gate_frame(
    along: float, across: float, heading: float, north: float, east: float
) -> tuple[float, float]:
    """North and east of a point given along and across (to starboard of) a gate's direction."""
    cos, sin = math.cos(heading), math.sin(heading)
    return north + along * cos - across * sin, east + along * sin + across * cos


def crosses(start: tuple[float, float], end: tuple[float, float], heading: float = 0.0) -> bool:
    """Whether a gate at the origin is crossed on the way between two points of its own frame."""
    way = (*in_gate_frame(*start, heading, 0.0, 0.0), *in_gate_frame(*end, heading, 0.0, 0.0))
    return crosses_gate(*way, 0.0, 0.0, math.cos(heading), math.sin(heading), HALF_WIDTH)


@given(st.floats(-10.0, -0.1), st.floats(0.1, 10.0), st.floats(-6.0, 6.0), st.floats(-6.0, 6.0), angle)
def test_a_way_forward_through_the_line_counts_exactly_between_the_buoys(
    before: float, after: float, across0: float, across1: float, heading: float
) -> None:
    at_line = across0 + (across1 - across0) * -before / (after - before)
    assume(abs(abs(at_line) - HALF_WIDTH) > 1e-9)
    assert crosses((before, across0), (after, across1), heading) == (abs(at_line) < HALF_WIDTH)


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(-6.0, 6.0), st.floats(-6.0, 6.0), angle)
def test_a_way_back_or_one_that_stays_on_its_side_never_counts(
    along0: float, along1: float, across0: float, across1: float, heading: float
) -> None:
    assume(along1 < along0 - 1e-9 or along0 * along1 > 1e-9)
    assert not crosses((along0, across0), (along1, across1), heading)


@given(st.floats(-5.0, -0.01), st.floats(0.0, 1.9))
def test_a_way_in_two_pieces_that_meet_on_the_line_counts_once(before: float, across: float) -> None:
    pieces = [crosses((before, across), (0.0, across)), crosses((0.0, across), (1.0, across))]
    assert pieces == [True, False]


def test_a_track_shifted_past_the_buoy_does_not_pass() -> None:
    track = [(-1.0 + 0.3 * i, 0.5 * math.sin(0.3 * i)) for i in range(10)]
    for shift, passes in [(0.0, True), (3.0, False), (-3.0, False)]:
        moved = [(along, across + shift) for along, across in track]
        counted = [crosses(a, b) for a, b in pairwise(moved)]
        assert sum(counted) == passes


@given(place, place, place, place, place, place)
def test_the_distance_to_a_way_is_the_least_of_many_of_its_points(
    n0: float, e0: float, n1: float, e1: float, north: float, east: float
) -> None:
    shares = np.linspace(0.0, 1.0, 2001)
    distances = np.hypot(n0 + shares * (n1 - n0) - north, e0 + shares * (e1 - e0) - east)
    spacing = math.hypot(n1 - n0, e1 - e0) / 2000
    found = math.sqrt(squared_distance_to_way(n0, e0, n1, e1, north, east))
    assert distances.min() - spacing - 1e-9 <= found <= distances.min() + 1e-9


def test_a_buoy_between_two_points_of_the_track_is_touched() -> None:
    assert touches_buoy(0.0, -1.0, 0.0, 1.0, 0.5, 0.0, 0.75)
    assert not touches_buoy(0.0, -1.0, 0.0, 1.0, 0.8, 0.0, 0.75)
    assert not touches_buoy(0.0, -3.0, 0.0, -1.0, 0.5, 0.0, 0.75)


@pytest.mark.parametrize(
    ("north", "east", "expected"),
    [
        (0.0, 0.0, False),
        (3.0, 5.0, False),
        (-2.1, 0.0, True),
        (3.1, 0.0, True),
        (0.0, -4.1, True),
        (0.0, 5.1, True),
        (math.nan, 0.0, True),
        (0.0, math.nan, True),
    ],
)
def test_each_edge_bounds_its_own_side(north: float, east: float, expected: bool) -> None:
    assert outside(north, east, -2.0, 3.0, -4.0, 5.0) == expected


GATE = np.array([0.0, 0.0, 1.0, 0.0, HALF_WIDTH])


def test_on_the_axis_before_the_gate_the_way_is_the_distance() -> None:
    assert distance_to_gate(-7.0, 0.0, GATE) == pytest.approx(7.0)


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(0.01, 10.0))
def test_beyond_the_gate_it_is_further_than_anywhere_as_far_before_it(
    across: float, other: float, along: float
) -> None:
    assume(abs(other) <= abs(across))
    assert distance_to_gate(along, across, GATE) > distance_to_gate(-along, other, GATE) - 1e-12


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01))
def test_the_distance_never_jumps_but_across_the_line_through_the_buoys(
    north: float, east: float, step_north: float, step_east: float
) -> None:
    blocked = abs(east) < HALF_WIDTH + 1.6
    assume(not (blocked and (north < 0.0) != (north + step_north < 0.0)))
    change = distance_to_gate(north + step_north, east + step_east, GATE) - distance_to_gate(
        north, east, GATE
    )
    assert abs(change) <= ACROSS * math.hypot(step_north, step_east) + 1e-12


@given(angle, place, place, st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
def test_the_distance_does_not_depend_on_where_the_gate_stands(
    heading: float, gate_north: float, gate_east: float, along: float, across: float
) -> None:
    assume(abs(along) > 1e-6)
    turned = np.array([gate_north, gate_east, math.cos(heading), math.sin(heading), HALF_WIDTH])
    point = in_gate_frame(along, across, heading, gate_north, gate_east)
    assert distance_to_gate(*point, turned) == pytest.approx(distance_to_gate(along, across, GATE), abs=1e-6)


def test_the_way_to_go_counts_the_gates_that_are_left() -> None:
    gates = np.array([[8.0, 0.0, 1.0, 0.0, 2.0], [22.0, 0.0, 1.0, 0.0, 2.0]])
    assert distance_to_go(0.0, 0.0, 0, gates) == pytest.approx(22.0)
    assert distance_to_go(8.0, 0.0, 1, gates) == pytest.approx(14.0)
    assert distance_to_go(22.0, 0.0, 2, gates) == 0.0
