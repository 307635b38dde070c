"""How near a track came to a buoy agrees with whether it touched one."""

import numpy as np
import pytest

from swamp_rl.course import buoy_table, load_course
from swamp_rl.course.clearance import closest_buoy
from swamp_rl.course.outcome import BUOY, outcome_of

COURSE, BREADTH = load_course("camogli"), 1.1


def test_a_track_between_two_places_passes_a_buoy_at_the_distance_from_the_line() -> None:
    north, east = buoy_table(COURSE)[0]
    track = np.array([[north - 3.0, east - 2.0, 0.0], [north + 3.0, east - 2.0, 0.0]])
    assert closest_buoy(track, COURSE, BREADTH) == pytest.approx(2.0 - COURSE.buoy_radius - 0.5 * BREADTH)
    short = track[[0, 0]] + np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert closest_buoy(short, COURSE, 0.0) == pytest.approx(np.hypot(2.0, 2.0) - COURSE.buoy_radius)


def test_it_is_negative_where_a_buoy_was_touched_and_only_there() -> None:
    rng, seen = np.random.default_rng(2), set()
    for _ in range(200):
        track = np.cumsum(rng.normal((0.4, 0.15), 0.5, (40, 2)), axis=0)
        outcome = outcome_of(np.arange(40.0) * 0.1, track, COURSE, BREADTH)
        if outcome in (BUOY, "incomplete"):
            seen.add(outcome)
            assert (closest_buoy(track, COURSE, BREADTH) < 0.0) == (outcome == BUOY)
    assert seen == {BUOY, "incomplete"}
