"""Distances of tracks against plane geometry."""

import numpy as np
import pytest

from swamp_rl.evaluation.tracks import (
    along,
    distances,
    mean_other,
    nearest_of_fewer,
    nearest_other,
    outside,
)

WAY = np.linspace(0.0, 10.0, 31)
NORTHWARD = np.column_stack([WAY, np.zeros(31)])


def eastward(metres: float) -> np.ndarray:
    """The same track so far to the east."""
    return NORTHWARD + np.array([0.0, metres])


def test_tracks_side_by_side_are_as_far_apart_as_they_lie() -> None:
    assert distances([NORTHWARD], [eastward(3.0)])[0, 0] == pytest.approx(3.0)


def test_the_same_way_at_another_speed_is_the_same_track() -> None:
    slow_then_fast = np.column_stack([10.0 * np.linspace(0.0, 1.0, 400) ** 3, np.zeros(400)])
    assert distances([NORTHWARD], [slow_then_fast])[0, 0] == pytest.approx(0.0, abs=1e-9)


def test_places_along_a_corner_are_equally_spaced_on_its_way() -> None:
    corner = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]])
    assert along(corner, 5).tolist() == [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1]]
    assert along(np.zeros((4, 3)), 2).tolist() == [[0, 0], [0, 0]]


def test_a_copy_lies_at_its_run_but_for_the_share_in_which_that_is_left_out() -> None:
    runs = [eastward(east) for east in (0.0, 1.0, 5.0, 9.0)]
    copy = distances([NORTHWARD], runs)
    assert nearest_of_fewer(copy) == pytest.approx([0.0 + 1.0 / 4])
    among = distances(runs, runs)
    assert nearest_other(among) == pytest.approx([1.0, 1.0, 4.0, 4.0])
    assert mean_other(among)[0] == pytest.approx((1.0 + 5.0 + 9.0) / 3)


def test_leaving_each_run_out_in_turn_is_what_the_shortcut_says() -> None:
    table = np.random.default_rng(0).random((6, 5))
    by_hand = np.mean([np.delete(table, i, axis=1).min(axis=1) for i in range(5)], axis=0)
    assert nearest_of_fewer(table) == pytest.approx(by_hand)
    with pytest.raises(ValueError, match="two tracks"):
        nearest_of_fewer(table[:, :1])


def test_a_track_alone_has_no_others() -> None:
    assert np.isnan(mean_other(np.zeros((1, 1)))).all()
    assert distances([], [NORTHWARD]).shape == (0, 1) and mean_other(distances([], [])).shape == (0,)


def test_places_are_outside_beyond_the_hull_of_all_tracks_together() -> None:
    square = [np.array([[0.0, 0.0], [2.0, 0.0]]), np.array([[2.0, 2.0], [0.0, 2.0]])]
    assert outside(np.array([[1.0, 1.0], [-0.1, 1.0], [3.0, 3.0]]), square).tolist() == [False, True, True]
