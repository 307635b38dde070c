"""A course for a boat of another size, by Froude's law."""

from pathlib import Path

import pytest

from swamp_rl.course import fitted, load_course

SWAMP_LENGTH = 1.24


def test_the_boat_that_a_course_names_sails_it_as_it_stands() -> None:
    course = load_course("camogli")
    own = fitted(course, SWAMP_LENGTH, 1.39)
    assert own == course.model_copy(update={"boat_length": None, "boat_speed": None})
    assert fitted(own, 20.0, 0.1) is own


@pytest.mark.parametrize("scale", [0.25, 4.0, 16.0])
def test_lengths_grow_with_the_boat_and_the_time_limit_with_its_root(scale: float) -> None:
    course = load_course("camogli")
    large = fitted(course, scale * SWAMP_LENGTH, 10.0)
    assert large.gates[1].centre.east == pytest.approx(scale * course.gates[1].centre.east)
    assert large.gates[0].width == pytest.approx(scale * course.gates[0].width)
    assert large.bounds.south == pytest.approx(scale * course.bounds.south)
    assert large.start.spread.north == pytest.approx(scale * course.start.spread.north)
    assert large.start.spread.heading == course.start.spread.heading
    assert large.time_limit == pytest.approx(scale**0.5 * course.time_limit)


def test_a_slow_boat_has_more_time_in_proportion() -> None:
    course = load_course("camogli")
    assert course.boat_speed is not None
    slow = fitted(course, SWAMP_LENGTH, 0.5 * course.boat_speed)
    assert slow.time_limit == pytest.approx(2.0 * course.time_limit)


@pytest.mark.parametrize(
    "own", ["scale: 2", "buoy_radius: 0.3", "bounds: {south: -50, north: 50, west: -50, east: 50}"]
)
def test_a_course_with_a_scale_or_lengths_of_its_own_is_laid_out_as_it_stands(
    tmp_path: Path, own: str
) -> None:
    (tmp_path / "own.yaml").write_text(
        f"extends: camogli\n{own}\n".replace("-50", "-50.0").replace(" 50", " 50.0")
    )
    course = load_course(tmp_path / "own.yaml")
    assert course.boat_length is None
    assert fitted(course, 20.0) is course


def test_a_course_that_changes_the_time_limit_alone_still_fits_the_boat(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text("extends: camogli\ntime_limit: 60.0\n")
    course = fitted(load_course(tmp_path / "own.yaml"), 4.0 * SWAMP_LENGTH)
    assert (course.gates[0].width, course.time_limit) == pytest.approx((16.0, 120.0))
