"""Squat by its formula, and missions in shallow water: flown, refused, aground."""

import json
import math
from pathlib import Path

import pytest
from swamp_rl.experiments.reports.mission import lines, write_mission

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.squat import clearance, critical_speed, squat
from swamp_rl.energy.figures import summary
from swamp_rl.energy.fly import fly
from swamp_rl.energy.mission import Mission
from swamp_rl.errors import UserError


@pytest.fixture(scope="module")
def light() -> Boat:
    return load_boat("swamp-light")


def mission(*legs: dict[str, float]) -> Mission:
    timed = [{"duration_s": 30.0, "course_deg": 0.0, **leg} for leg in legs]
    return Mission.model_validate({"name": "m", "boat": "swamp", "legs": timed})


def test_squat_grows_with_speed_load_and_shallowness_up_to_the_critical_speed(light: Boat) -> None:
    swamp = load_boat("swamp")
    sinkages = [squat(swamp, speed, 0.3) for speed in (0.0, 0.4, 0.8, 1.2)]
    assert sinkages[0] == 0.0 and sinkages == sorted(sinkages)
    assert squat(light, 0.8, 0.3) < squat(swamp, 0.8, 0.3) < squat(swamp, 0.8, 0.25)
    assert clearance(swamp, 0.8, 0.3) == pytest.approx(0.3 - 0.14 - squat(swamp, 0.8, 0.3))
    with pytest.raises(ValueError, match="critical speed"):
        squat(swamp, critical_speed(0.3), 0.3)


def test_a_boat_that_squats_onto_the_ground_ends_its_mission_there(light: Boat, tmp_path: Path) -> None:
    flight = fly(light, mission({"speed": 0.5, "depth": 0.3}, {"speed": 0.9, "depth": 0.14}), "m.yaml")
    touch = flight.aground
    assert touch is not None and touch.leg == 1
    assert touch.draught + touch.squat >= touch.depth == 0.14
    assert 0.5 < touch.speed < 0.9
    assert flight.time[-1] == pytest.approx(touch.time) and len(flight.leg) == len(flight.states) - 1
    before = math.hypot(*flight.states[-2, 3:5])
    assert clearance(light, before, 0.14) > 0.0  # it floated a step before
    assert summary(flight)["outcome"] == "aground" and "aground after" in lines(flight)[-1]
    write_mission(tmp_path / "out", flight)
    data = json.loads((tmp_path / "out/mission.json").read_text())
    assert data["aground"]["depth"] == 0.14 and data["outcome"] == "aground"


def test_shallow_legs_take_more_energy_and_the_load_decides_where_ground_is_touched(light: Boat) -> None:
    deep, shallow = (
        fly(light, mission(leg), "m.yaml") for leg in ({"speed": 0.8}, {"speed": 0.8, "depth": 0.2})
    )
    assert shallow.aground is None and summary(shallow)["outcome"] == "completed"
    hotel = 2.0 * 88.0 * 30.0  # J, of both packs
    assert shallow.packs.energy[-1].sum() - hotel > 1.1 * (deep.packs.energy[-1].sum() - hotel)
    loaded = load_boat("swamp")
    assert clearance(light, 0.7, 0.16) > 0.0 > clearance(loaded, 0.7, 0.16)


@pytest.mark.parametrize(
    ("leg", "message"),
    [
        ({"speed": 0.5, "depth": 0.15}, "legs.0.depth: 0.15 m is 1.3 draughts"),
        ({"speed": 0.5, "depth": 0.1}, "it lies aground"),
        ({"speed": 1.3, "depth": 0.15}, "above the critical speed 1.21 m/s"),
    ],
)
def test_a_depth_without_an_answer_is_refused(light: Boat, leg: dict[str, float], message: str) -> None:
    with pytest.raises(UserError, match=r"m\.yaml: legs\.0") as refused:
        fly(light, mission(leg), "m.yaml")
    assert message in str(refused.value)
