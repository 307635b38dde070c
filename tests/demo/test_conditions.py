"""Whether runs met one start and one weather depends on their metadata alone."""

import numpy as np
import pytest

from swamp_rl.course import load_course
from swamp_rl.demo.conditions import conditions
from swamp_rl.demo.scene import demo_scene
from swamp_rl.runs import Run, RunMeta
from tests.support.runs import circling

START = {"north": 0.1, "east": 0.2, "heading": -0.3, "surge": 0.0, "sway": 0.0, "yaw_rate": 0.0}
META = {
    "seed": 7,
    "initial_state": START,
    "disturbances": [{"effect": "wind", "speed": 3.0, "from": 0.5}],
    "gust_seed": 11,
    "level": "standard",
}


def run(name: str = "a", **changes: object) -> Run:
    return Run(name, circling(), RunMeta.model_validate(META | changes))


def test_the_same_start_and_weather_are_said_with_level_and_seed() -> None:
    found = conditions([run(), run("b")])
    assert found.same and found.sentence == "same start, same weather: standard, seed 7"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"disturbances": [{"effect": "wind", "speed": 3.1, "from": 0.5}]}, "different weather"),
        ({"gust_seed": 12}, "different weather"),
        ({"initial_state": START | {"east": 0.3}}, "different starts, same weather: standard"),
        ({"initial_state": START | {"surge": 0.3}}, "different starts, same weather: standard"),
        ({"disturbances": "standard"}, "different weather: b does not record its own"),
        ({"disturbances": None}, "different weather: b does not record its own"),
        ({"initial_state": None}, "different weather: b does not record its own"),
        ({"gust_seed": None}, "different weather: b does not record its own"),
        ({"kicked_steps": 3}, "different weather: in b someone moved the stern thrusters"),
    ],
)
def test_whatever_differs_or_is_not_reported_is_said(changes: dict[str, object], message: str) -> None:
    found = conditions([run(), run("b", **changes)])
    assert not found.same and found.sentence == message


def test_without_disturbances_the_seed_of_the_gusts_does_not_matter() -> None:
    calm = {"disturbances": [], "level": "none"}
    found = conditions([run(**calm), run("b", gust_seed=12, **calm)])
    assert found.same and found.sentence == "same start, same weather: calm, seed 7"


def test_runs_of_different_boats_do_not_compare() -> None:
    assert conditions([run(), run("b")], one_boat=False).sentence == "different boats"


def test_runs_of_one_weather_start_together_and_others_are_aligned_at_the_gate() -> None:
    course = load_course("camogli")
    fair = demo_scene("a", {"x": [run()], "y": [run("b")]}, course, (1.24, 1.1), None)
    assert [item.start for item in fair.shown] == [0.0, 0.0] and fair.aligned == "all runs start together"
    later = Run("b", circling() | {"north": 6.0 + circling()["time"]}, RunMeta())
    unfair = demo_scene("a", {"x": [run()], "y": [later]}, course, (1.24, 1.1), None)
    assert "gate" in unfair.aligned and len(np.unique([item.start for item in unfair.shown])) == 2
    assert "different weather" in unfair.about
