"""The end card's figures are those of known tracks."""

import numpy as np
import pytest

from swamp_rl.course import buoy_table, load_course
from swamp_rl.demo.card import HEAD, NONE, card
from swamp_rl.demo.scene import demo_scene
from swamp_rl.runs import Run, RunMeta

COURSE, BREADTH = load_course("camogli"), 1.1
TIME = np.arange(101) * 0.1
BUOY = buoy_table(COURSE)[1]


def northward(name: str, beside: float, outcome: str | None = "success", step: float = 0.1) -> Run:
    """10 m at one speed, `beside` metres east of the second buoy, its angle lever going to and fro by 0.2."""
    columns = {
        "time": TIME * step / 0.1,
        "north": TIME,
        "east": BUOY[1] + beside + 0.0 * TIME,
        "heading": 0.0 * TIME,
        "joy_thrust": np.ones(101),
        "joy_angle": 0.1 * (-1.0) ** np.arange(101),
    }
    return Run(name, columns, RunMeta(outcome=outcome))


def test_time_path_lever_change_and_clearance_are_those_of_the_track() -> None:
    scene = demo_scene("a", {"x": [northward("a", 3.0)]}, COURSE, (1.24, BREADTH))
    (line,) = card(scene)
    clear = 3.0 - COURSE.buoy_radius - 0.5 * BREADTH
    assert line.cells == ("x", "success", "10.0", "10.0", "0.200", f"{clear:.2f}")
    assert len(line.cells) == len(HEAD) and line.colour == scene.fleets[0].colour


def test_what_is_not_known_or_does_not_compare_is_left_out() -> None:
    two = {"x": [northward("a", 3.0, None)], "y": [northward("b", 3.0, step=0.2)]}
    cells = [line.cells for line in card(demo_scene("a", two, None, (1.24, BREADTH)))]
    assert cells == [("x", NONE, "10.0", "10.0", NONE, NONE), ("y", "success", "20.0", "10.0", NONE, NONE)]


@pytest.mark.parametrize("count", [9, 20])
def test_a_driver_of_many_runs_has_one_line(count: int) -> None:
    groups = {"x": [northward(f"r{i}", -1.9 + 0.1 * i) for i in range(count)], "y": [northward("s", 4.0)]}
    lines = card(demo_scene("a", groups, COURSE, (1.24, BREADTH)))
    middle = np.median(np.abs(-1.9 + 0.1 * np.arange(count))) - COURSE.buoy_radius - 0.5 * BREADTH
    assert [line.cells[:2] for line in lines] == [
        ("x", f"{count} of {count} success"),
        ("y", "1 of 1 success"),
    ]
    assert float(lines[0].cells[-1]) == pytest.approx(middle, abs=0.006)
