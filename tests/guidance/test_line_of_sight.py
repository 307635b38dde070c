"""Guidance along lines agrees with plain geometry, and the heading control with itself mirrored."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.angles import wrapped
from swamp_rl.guidance.heading import Limits, steering_angle
from swamp_rl.guidance.line_of_sight import Waypoint, bearing, leg_after, line_of_sight, offset

metres = st.floats(-50.0, 50.0)
angles = st.floats(-20.0, 20.0)


def test_east_of_a_line_to_the_north_is_to_starboard() -> None:
    seen = offset(Waypoint(3.0, 2.0), Waypoint(0.0, 0.0), Waypoint(10.0, 0.0))
    assert seen == pytest.approx((3.0, 2.0))


def test_on_the_line_the_course_is_the_lines_and_a_lookahead_aside_it_turns_by_45_degrees() -> None:
    start, end = Waypoint(0.0, 0.0), Waypoint(0.0, 10.0)
    assert line_of_sight(Waypoint(0.0, 4.0), start, end, 3.0) == pytest.approx(math.pi / 2)
    assert line_of_sight(Waypoint(-3.0, 4.0), start, end, 3.0) == pytest.approx(math.pi / 4)


@given(metres, metres, metres, metres, metres, metres)
def test_along_and_across_keep_the_distance(
    a: float, b: float, c: float, d: float, e: float, f: float
) -> None:
    start, end, place = Waypoint(a, b), Waypoint(c, d), Waypoint(e, f)
    assert math.hypot(*offset(place, start, end)) == pytest.approx(math.dist(place, start), abs=1e-9)


@given(metres, metres)
def test_the_course_points_at_the_line_a_lookahead_on(north: float, east: float) -> None:
    start, end, place = Waypoint(0.0, 0.0), Waypoint(100.0, 0.0), Waypoint(north, east)
    aim = Waypoint(north + 4.0, 0.0)
    difference = wrapped(line_of_sight(place, start, end, 4.0) - bearing(place, aim))
    assert difference == pytest.approx(0.0, abs=1e-9)


def test_legs_change_near_a_waypoint_but_the_last_must_be_passed() -> None:
    waypoints = [Waypoint(0.0, 0.0), Waypoint(10.0, 0.0), Waypoint(10.0, 10.0)]
    assert leg_after(Waypoint(5.0, 0.0), waypoints, 0, 2.0) == 0
    assert leg_after(Waypoint(8.5, 0.0), waypoints, 0, 2.0) == 1
    assert leg_after(Waypoint(10.0, 9.0), waypoints, 1, 2.0) == 1
    assert leg_after(Waypoint(11.0, 10.1), waypoints, 1, 2.0) == 2


@given(angles, angles, st.floats(-2.0, 2.0), st.floats(0.0, 2.0))
def test_a_mirrored_error_is_answered_by_the_mirrored_angle(
    wanted: float, heading: float, rate: float, speed: float
) -> None:
    error = wrapped(wanted - heading)
    if abs(error) > math.pi - 1e-6:
        return
    one = steering_angle(error, 0.0, rate, speed, 1.24, Limits(0.5))
    assert steering_angle(-error, 0.0, -rate, speed, 1.24, Limits(0.5)) == pytest.approx(-one, abs=1e-12)
    assert abs(one) <= 0.5
