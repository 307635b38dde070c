"""The heading loop of a trial is stable whatever the boat's thrust, lags and size."""

import math
from pathlib import Path

import pytest
import yaml

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS, boat_file
from swamp_rl.constants import GRAVITY
from swamp_rl.guidance.heading import Limits, steering_angle
from swamp_rl.manoeuvres.controller import Trial
from swamp_rl.manoeuvres.execute import STEP, execute
from swamp_rl.manoeuvres.steering_response import stable_gain
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import SURGE, YAW_RATE

FULL = Trial("straight", 1.0, duration=5.0)


def light_boat(folder: Path, kind: str, thrust: float) -> Boat:
    """A boat of 1.1 m and 25 kg whose thrust is that share of its weight."""
    path = folder / "light.yaml"
    content = boat_file("light", kind, 1.1, 0.6, 25.0, thrust * 25.0 * GRAVITY)
    path.write_text(yaml.safe_dump(content))
    return load_boat(path)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "propeller-rudder"])
def test_a_light_boat_of_great_thrust_goes_straight_at_its_top_speed(tmp_path: Path, kind: str) -> None:
    boat = light_boat(tmp_path, kind, 0.5)
    (executed,) = execute(boat, [FULL])
    assert executed.notes == ()
    last = executed.track[-round(FULL.duration / STEP) :]
    assert last[:, SURGE].mean() == pytest.approx(reference_of(boat).speed, rel=0.01)
    assert abs(last[:, YAW_RATE]).max() < math.radians(1.0)


@pytest.mark.parametrize("inward", [1.0, -1.0])
def test_four_thrusters_at_45_degrees_go_straight_at_top_speed_and_turn_where_they_are_told(
    tmp_path: Path, inward: float
) -> None:
    content = boat_file("crossed", "four-fixed", 1.1, 0.6, 25.0, 80.0)
    for thruster in content["thrusters"]:
        for end in ("azimuth_min", "azimuth_max"):
            thruster[end] = inward * thruster[end]["value"]
    (tmp_path / "crossed.yaml").write_text(yaml.safe_dump(content))
    boat = load_boat(tmp_path / "crossed.yaml")
    circle = Trial("turning-circle", 0.6, angle=math.radians(30.0), turns=1)
    ahead, turned = execute(boat, [FULL, circle])
    assert ahead.notes == ()
    assert ahead.track[-1, SURGE] == pytest.approx(reference_of(boat).speed, rel=0.01)
    assert turned.completed and turned.track[-1, YAW_RATE] > 0.0


def test_the_gain_falls_with_the_thrust_that_turns_the_boat(tmp_path: Path) -> None:
    weak = stable_gain(light_boat(tmp_path, "twin-fixed", 0.1), FULL, STEP)
    strong = stable_gain(light_boat(tmp_path, "twin-fixed", 0.4), FULL, STEP)
    assert strong == pytest.approx(weak / 4.0, rel=0.3)


def test_the_gain_leaves_the_steering_of_the_reference_boat_as_it_is() -> None:
    boat = load_boat("swamp")
    speed = reference_of(boat).speed
    limits = Limits(1.0, stable_gain(boat, FULL, STEP))
    for error, rate in ((0.05, 0.0), (0.0, 0.02), (0.1, -0.05)):
        plain = steering_angle(error, 0.0, rate, speed, boat.length, Limits(1.0))
        assert steering_angle(error, 0.0, rate, speed, boat.length, limits) == plain


def test_a_boat_that_no_angle_turns_has_no_limit(tmp_path: Path) -> None:
    content = boat_file("towed", "twin-fixed", 1.1, 0.6, 25.0, 100.0)
    for thruster in content["thrusters"]:
        thruster["y"]["value"] = 0.0
    (tmp_path / "towed.yaml").write_text(yaml.safe_dump(content))
    assert stable_gain(load_boat(tmp_path / "towed.yaml"), FULL, STEP) == math.inf
