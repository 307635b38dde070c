"""Boats of other sizes and thrusters than SWAMP's are watched as well."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import Kind, annotated, boat_file
from swamp_rl.link import Sample
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import commands_of
from swamp_rl.monitor import Monitor, Notice
from swamp_rl.monitor.tracker import scale_of
from tests.support.live_stream import stream
from tests.support.new_boats import sailed

BEGINS = 45.0
KINGFISHER: tuple[Kind, float, float, float, float] = ("twin-fixed", 1.35, 0.98, 28.0, 41.4)
"Kind, length, breadth [m], mass [kg] and bollard pull [N] of the Kingfisher M200."
SHIP: tuple[Kind, float, float, float, float] = ("propeller-rudder", 4.0, 0.7, 400.0, 120.0)


def made(folder: Path, given: tuple[Kind, float, float, float, float]) -> Boat:
    path = folder / "boat.yaml"
    path.write_text(annotated(boat_file("new", *given), "a test"), encoding="utf-8")
    return load_boat(path)


def streamed(boat: Boat, seconds: float, effects: list[dict[str, Any]]) -> Iterable[Sample]:
    command = commands_of(boat, "opposed")
    return stream(seconds, BEGINS, effects, boat=boat, turn=lambda angle: command(Order(angle, 0.6)))


def notices(boat: Boat, seconds: float, effects: list[dict[str, Any]]) -> list[Notice]:
    monitor = Monitor(boat)
    return [notice for sample in streamed(boat, seconds, effects) for notice in monitor.feed(sample)]


@pytest.mark.parametrize("given", [KINGFISHER, SHIP], ids=["kingfisher", "ship"])
def test_a_failure_is_named_and_nothing_before_it(
    tmp_path: Path, given: tuple[Kind, float, float, float, float]
) -> None:
    boat = made(tmp_path, given)
    name = boat.thruster_names[0]
    first = notices(boat, BEGINS + 10.0, [{"effect": "thruster_failure", "thruster": name, "time": 0.0}])[0]
    assert first.cause == f"thruster_failure {name}"
    assert BEGINS <= first.time <= BEGINS + 8.0


def test_a_current_that_rises_is_named_on_a_ship(tmp_path: Path) -> None:
    first = notices(made(tmp_path, SHIP), BEGINS + 10.0, [{"effect": "current", "north": 0.3, "east": -0.2}])[
        0
    ]
    assert first.cause == "current"
    assert first.values["north"] > 0.0 > first.values["east"]


def test_the_current_of_a_model_ship_has_the_size_of_the_one_that_rose() -> None:
    effect = {"effect": "current", "north": 0.3, "east": -0.2}
    first = notices(load_boat("esso_osaka"), BEGINS + 5.0, [effect])[0]
    assert first.cause == "current"
    assert first.values["north"] == pytest.approx(0.3, abs=0.1)
    assert first.values["east"] == pytest.approx(-0.2, abs=0.1)


def test_the_filter_expects_the_speeds_that_the_boat_reaches(tmp_path: Path) -> None:
    boat = made(tmp_path, SHIP)
    reached = sailed(boat, 0.0, 400.0, throttle=1.0)[-1, 3]
    scale = scale_of(boat)
    np.testing.assert_allclose(scale[:3], [4.0, 4.0, 1.0])
    np.testing.assert_allclose(scale[3:], np.array([1.0, 1.0, 0.25, 1.0, 1.0]) * reached, rtol=0.02)
