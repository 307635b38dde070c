"""Course files: what they hold, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from swamp_rl.course import buoy_table, gate_table, load_course
from swamp_rl.errors import UserError
from swamp_rl.files import find_config


def course_file(folder: Path, **changes: object) -> Path:
    data = yaml.safe_load(find_config("courses", "camogli").read_text(encoding="utf-8"))
    path = folder / "course.yaml"
    path.write_text(yaml.safe_dump(data | changes), encoding="utf-8")
    return path


def test_camogli_has_the_green_then_the_red_gate_passed_northward() -> None:
    course = load_course("camogli")
    gates = [(g.name, g.centre.north, g.centre.east, g.heading, g.width) for g in course.gates]
    assert gates == [("green", 8.0, 0.0, 0.0, 4.0), ("red", 22.0, 8.0, 0.0, 4.0)]


def test_camogli_says_that_its_numbers_are_not_the_thesis() -> None:
    assert "is ours" in find_config("courses", "camogli").read_text(encoding="utf-8")


def test_port_and_starboard_buoys_stand_abeam_of_one_who_passes(tmp_path: Path) -> None:
    # Passed eastward, port is to the north.
    gate = {"name": "one", "centre": {"north": 3.0, "east": 2.0}, "heading": math.pi / 2, "width": 4.0}
    course = load_course(course_file(tmp_path, gates=[gate]))
    assert buoy_table(course) == pytest.approx(np.array([[5.0, 2.0], [1.0, 2.0]]))
    assert gate_table(course) == pytest.approx(np.array([[3.0, 2.0, 0.0, 1.0, 2.0]]))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gate": []}, "did you mean 'gates'?"),
        ({"gates": []}, "gates"),
        ({"buoy_radius": 0.0}, "buoy_radius"),
        ({"buoy_radius": 2.0}, "gate green: width"),
        ({"time_limit": "long"}, "time_limit"),
        ({"time_limit": float("inf")}, "time_limit"),
        ({"bounds": {"south": 1.0, "north": -1.0, "west": -9.0, "east": 9.0}}, "south must be less"),
        ({"bounds": {"south": -9.0, "north": 9.0, "west": -9.0, "east": 9.0}}, "gate red: a buoy is outside"),
    ],
)
def test_an_impossible_course_is_refused_in_one_line_with_file_and_key(
    tmp_path: Path, changes: dict[str, object], message: str
) -> None:
    path = course_file(tmp_path, **changes)
    with pytest.raises(UserError) as error:
        load_course(path)
    assert message in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_heading_in_degrees_is_refused(tmp_path: Path) -> None:
    gate = {"name": "one", "centre": {"north": 3.0, "east": 2.0}, "heading": 90.0, "width": 4.0}
    with pytest.raises(UserError, match=r"gates\.0\.heading: must be .* not 90; 90 degrees are 1\.571 rad"):
        load_course(course_file(tmp_path, gates=[gate]))


def test_a_spread_of_the_heading_in_degrees_is_refused(tmp_path: Path) -> None:
    start = {
        "pose": {"north": 0.0, "east": 0.0, "heading": 0.0},
        "spread": {"north": 0.5, "east": 0.5, "heading": 5.0},
    }
    path = tmp_path / "wide.yaml"
    path.write_text(yaml.safe_dump({"extends": "camogli", "name": "wide", "start": start}))
    with pytest.raises(UserError, match=r"at most half a turn, not 5 rad; 5 degrees are 0\.08727 rad"):
        load_course(path)


def test_a_course_that_extends_another_gives_only_the_keys_that_differ(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(
        "extends: camogli\nstart: {spread: {heading: 0.3}}\ngates: {red: {width: 6.0}}\n"
    )
    own, whole = load_course(tmp_path / "own.yaml"), load_course("camogli")
    assert own.start.spread.heading == 0.3 and own.gates[1].width == 6.0
    assert own.start.pose == whole.start.pose and own.start.spread.north == whole.start.spread.north
    assert own.gates[0] == whole.gates[0] and own.gates[1].centre == whole.gates[1].centre


def test_two_gates_of_one_name_are_refused(tmp_path: Path) -> None:
    gate = {"name": "one", "centre": {"north": 3.0, "east": 2.0}, "heading": 0.0, "width": 4.0}
    with pytest.raises(UserError, match="same name"):
        load_course(course_file(tmp_path, gates=[gate, gate]))


def test_a_start_that_may_fall_outside_the_bounds_is_refused(tmp_path: Path) -> None:
    start = {
        "pose": {"north": -11.5, "east": 0.0, "heading": 0.0},
        "spread": {"north": 1.0, "east": 0.0, "heading": 0.0},
    }
    with pytest.raises(UserError, match="start"):
        load_course(course_file(tmp_path, start=start))


def test_a_misspelt_key_of_the_only_gate_is_not_reported_as_a_course_without_gates(tmp_path: Path) -> None:
    gate = {"name": "one", "center": {"north": 3.0, "east": 2.0}, "heading": 0.0, "width": 4.0}
    with pytest.raises(UserError) as error:
        load_course(course_file(tmp_path, gates=[gate]))
    assert "did you mean 'centre'?" in str(error.value)
    assert "at least" not in str(error.value)
    with pytest.raises(UserError, match="must have 1 or more entries, not 0"):
        load_course(course_file(tmp_path, gates=[]))
