"""Missions: the file is read strictly, the flight conserves energy, and what cannot be flown is refused."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.energy import pack_power
from swamp_rl.energy.figures import energy_per_metre, leg_figures, summary
from swamp_rl.energy.fly import STEP, Flight, fly
from swamp_rl.energy.mission import Mission, load_mission
from swamp_rl.errors import UserError
from swamp_rl.simulator.state import ACTUATORS, EAST, NORTH

GOOD = {"name": "mine", "boat": "swamp", "legs": [{"speed": 1.0, "duration_s": 60.0}]}


def mission(**keys: object) -> Mission:
    return Mission.model_validate({**GOOD, **keys})


@pytest.fixture(scope="module")
def swamp() -> Boat:
    return load_boat("swamp")


@pytest.fixture(scope="module")
def there_and_back(swamp: Boat) -> Flight:
    legs = [
        {"speed": 1.2, "duration_s": 60.0, "course_deg": 90.0},
        {"speed": 0.8, "waypoints": [[20.0, 40.0], [20.0, 0.0]]},
    ]
    return fly(swamp, mission(legs=legs), "mine.yaml")


def test_a_leg_goes_its_way_at_its_speed(there_and_back: Flight) -> None:
    first, second = leg_figures(there_and_back)
    assert first.duration == pytest.approx(60.0)
    assert there_and_back.speed[round(60.0 / STEP)] == pytest.approx(1.2, rel=0.01)
    turn = there_and_back.states[round(60.0 / STEP)]
    assert turn[EAST] > 60.0
    assert abs(turn[NORTH]) < 0.5
    assert there_and_back.states[-1, [NORTH, EAST]] == pytest.approx([20.0, 0.0], abs=0.5)
    assert second.speed == pytest.approx(0.8, rel=0.05)


def test_energy_is_the_sum_of_power_and_the_legs_make_the_whole(there_and_back: Flight, swamp: Boat) -> None:
    flight = there_and_back
    power = pack_power(swamp, flight.states[1:, ACTUATORS + 4 :])
    total = power.sum(axis=0) * STEP
    assert flight.packs.energy[-1] == pytest.approx(total)
    legs = leg_figures(flight)
    assert np.sum([leg.energy for leg in legs], axis=0) == pytest.approx(total)
    assert sum(leg.distance for leg in legs) == pytest.approx(flight.way[-1])
    assert sum(leg.duration for leg in legs) == pytest.approx(flight.time[-1])
    assert energy_per_metre(flight) == pytest.approx(total.sum() / flight.way[-1])
    assert summary(flight)["charge"] == pytest.approx(flight.packs.charge[-1].tolist())


def test_charge_never_rises(there_and_back: Flight) -> None:
    assert np.all(np.diff(there_and_back.packs.charge, axis=0) < 0.0)


def test_a_straight_leg_draws_the_same_from_both_hulls(swamp: Boat) -> None:
    flight = fly(swamp, mission(), "mine.yaml")
    starboard, port = flight.packs.energy[-1]
    assert starboard == pytest.approx(port, rel=1e-6)


def test_a_mirrored_mission_mirrors_the_packs(swamp: Boat) -> None:
    def turn(side: float) -> Flight:
        legs = [{"speed": 0.8, "waypoints": [[20.0, 0.0], [20.0, side * 15.0]]}]
        return fly(swamp, mission(legs=legs), "mine.yaml")

    one, other = turn(1.0), turn(-1.0)
    assert one.packs.energy[-1] == pytest.approx(other.packs.energy[-1, ::-1], rel=0.01)
    assert one.packs.energy[-1, 0] != pytest.approx(one.packs.energy[-1, 1], rel=1e-4)


def test_holding_the_commands_changes_neither_way_nor_energy(
    swamp: Boat, monkeypatch: pytest.MonkeyPatch
) -> None:
    legs = [{"speed": 1.0, "duration_s": 100.0}, {"speed": 0.7, "duration_s": 100.0}]
    held = fly(swamp, mission(legs=legs), "mine.yaml")
    monkeypatch.setattr("swamp_rl.energy.pilot.CALM", 10**9)
    always = fly(swamp, mission(legs=legs), "mine.yaml")
    assert held.packs.energy[-1] == pytest.approx(always.packs.energy[-1], rel=2e-3)
    assert held.way[-1] == pytest.approx(always.way[-1], rel=1e-3)


SAGGING = "extends: swamp\nbattery: {thrust_exponent: 2.0}\n"


def test_thrust_that_follows_the_voltage_falls_with_the_charge_and_draws_less(tmp_path: Path) -> None:
    (tmp_path / "b.yaml").write_text(SAGGING)
    boat = load_boat(tmp_path / "b.yaml")
    legs = [{"speed": 1.38, "duration_s": 100.0}]  # full throttle once the voltage is lower
    full, lower = (fly(boat, mission(charge=charge, legs=legs), "m.yaml") for charge in (1.0, 0.9))
    top = [float(flight.speed[-20:].mean()) for flight in (full, lower)]
    assert top[1] < top[0] - 0.005
    ratio = (32.0 + 8.0 * lower.packs.charge[100, 0]) / 40.0  # full throttle
    thrust = 12.2 * lower.states[101, ACTUATORS + 4] ** 2 * ratio**2
    assert lower.packs.power[100, 0] == pytest.approx(88.0 + 2 * (9.404 + 2.0237 * thrust**1.5), rel=1e-4)


def test_a_boat_whose_drives_regulate_their_speed_flies_alike_at_any_charge(swamp: Boat) -> None:
    full, low = (fly(swamp, mission(charge=charge), "m.yaml") for charge in (1.0, 0.3))
    np.testing.assert_array_equal(full.states, low.states)
    np.testing.assert_array_equal(full.packs.power, low.packs.power)
    assert np.all(low.packs.current > full.packs.current)


def test_more_than_the_battery_is_refused_with_the_place_where_it_ends(swamp: Boat) -> None:
    asked = mission(
        charge=0.11, legs=[{"speed": 1.2, "duration_s": 60.0}, {"speed": 1.2, "duration_s": 600.0}]
    )
    with pytest.raises(UserError) as refused:
        fly(swamp, asked, "mine.yaml")
    message = str(refused.value)
    assert message.startswith("mine.yaml: the mission needs more than the battery of boat swamp")
    assert "state of charge 0.1 after" in message
    assert "in legs.1" in message
    flight = fly(swamp, asked, "mine.yaml", even_if_empty=True)
    assert flight.emptied is None
    assert 0.0 < flight.packs.charge[-1].min() < 0.1


def test_a_flight_even_if_empty_ends_where_a_pack_is_empty(swamp: Boat) -> None:
    asked = mission(charge=0.02, reserve=0.01, legs=[{"speed": 1.2, "duration_s": 3600.0}])
    flight = fly(swamp, asked, "mine.yaml", even_if_empty=True)
    assert flight.emptied == pytest.approx(flight.time[-1])
    assert flight.packs.charge[-1].min() == pytest.approx(0.0, abs=1e-4)
    # 0.02 of 13 Ah at 32 V, and about 200 W of each pack
    assert flight.emptied == pytest.approx(0.02 * 46800.0 * 32.1 / 200.0, rel=0.1)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"legs": [{"speed": 1.5, "duration_s": 60.0}]}, "legs.0.speed: 1.5 m/s is above 1.39 m/s"),
        ({"charge": 0.05}, "must be above the reserve of 0.1"),
    ],
)
def test_what_the_boat_cannot_do_is_refused_before_it_is_flown(
    swamp: Boat, keys: dict[str, object], message: str
) -> None:
    with pytest.raises(UserError, match=r"^mine\.yaml: ") as refused:
        fly(swamp, mission(**keys), "mine.yaml")
    assert message in str(refused.value)


def test_a_speed_that_a_current_prevents_is_refused(tmp_path: Path) -> None:
    (tmp_path / "b.yaml").write_text("extends: swamp\neffects: [{effect: current, north: -0.6}]\n")
    with pytest.raises(UserError, match=r"legs\.0\.speed: 1 m/s is not reached: boat b makes 0\.\d+ m/s"):
        fly(load_boat(tmp_path / "b.yaml"), mission(legs=[{"speed": 1.0, "duration_s": 150.0}]), "m.yaml")


def test_a_current_above_the_packs_peak_is_refused(tmp_path: Path) -> None:
    (tmp_path / "b.yaml").write_text(
        "extends: swamp\nbattery: {current_continuous: 3.0, current_peak: 5.0}\n"
    )
    with pytest.raises(UserError, match=r"legs\.0: a pack would give \d.* A, its peak is 5 A"):
        fly(load_boat(tmp_path / "b.yaml"), mission(), "m.yaml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("legs: []", "legs"),
        ("legs: [{speed: 1.0}]", "give either duration_s or waypoints"),
        ("legs: [{speed: 1.0, duration_s: 5.0, waypoints: [[1.0, 2.0]]}]", "give either"),
        ("legs: [{speed: 1.0, waypoints: [[1.0, 2.0]], course_deg: 3.0}]", "course_deg"),
        ("legs: [{speed: 1.0, waypoints: [[0.0, 0.0]]}]", "legs.0.waypoints: two lie within"),
        ("legs: [{speed: -1.0, duration_s: 5.0}]", "legs.0.speed"),
        ("legs: [{speed: 1.0, duration_s: .nan}]", "legs.0.duration_s"),
        ("legs: [{speed: 0.1, duration_s: 86000.0}, {speed: 0.1, duration_s: 1000.0}]", "at most 86400 s"),
        ("legs: [{speed: 1.0, duration_s: 5.0}]\nspeeed: 3", "speeed"),
        ("legs: [{speed: 1.0, duration_s: 5.0}]\nreserve: 1.0", "reserve"),
    ],
)
def test_a_malformed_mission_is_refused_by_its_key(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(f"name: mine\nboat: swamp\n{text}\n")
    with pytest.raises(UserError) as refused:
        load_mission(path)
    assert message in str(refused.value)
    assert "mine.yaml" in str(refused.value)


def test_a_mission_tells_its_leg_and_time_as_it_goes(swamp: Boat, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("DEBUG", "swamp_rl.energy.fly")
    legs = [{"speed": 1.0, "duration_s": 400.0}, {"speed": 0.8, "duration_s": 300.0}]
    fly(swamp, mission(legs=legs), "mine.yaml")
    told = [f"leg {leg} of 2, {time} s sailed" for leg, time in ((1, 0), (1, 300), (2, 600))]
    assert caplog.messages == told
