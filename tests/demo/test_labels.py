"""Labels of boats that meet lie apart, each near its boat."""

from itertools import combinations

import numpy as np

from swamp_rl.demo.labels import apart

OFFSET = np.array([9.0, -12.0])


def overlaps(corners: np.ndarray, sizes: np.ndarray) -> int:
    """How many pairs of boxes share an area."""
    pairs = combinations(zip(corners + 1e-9, corners + sizes - 1e-9, strict=True), 2)
    return sum(bool((low < top).all() and (other < high).all()) for (low, high), (other, top) in pairs)


def test_labels_of_boats_at_one_place_do_not_overlap() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        points, sizes = rng.uniform(0.0, 60.0, (8, 2)), rng.uniform((30.0, 10.0), (80.0, 14.0), (8, 2))
        corners = apart(points, sizes, OFFSET)
        assert overlaps(points + OFFSET, sizes) > 0
        assert overlaps(corners, sizes) == 0
        assert (corners[:, 0] == points[:, 0] + 9.0).all()
        assert np.abs(corners[:, 1] - points[:, 1] + 12.0).max() < 8 * 2 * 14.0


def test_a_label_that_is_alone_lies_where_it_is_wanted() -> None:
    points = np.array([[0.0, 0.0], [500.0, 0.0]])
    assert (apart(points, np.full((2, 2), 10.0), OFFSET) == points + OFFSET).all()
