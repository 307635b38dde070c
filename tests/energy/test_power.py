"""Electric power of thrusters and packs: the source's anchors, symmetry, and what a boat file must hold."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.energy import missing, pack_power, range_left, stored_energy, thruster_power
from swamp_rl.errors import UserError


@pytest.fixture(scope="module")
def swamp() -> Boat:
    return load_boat("swamp")


def test_a_jet_draws_what_the_thesis_measured_at_its_design_thrust(swamp: Boat) -> None:
    throttle = np.full(4, np.sqrt(12.3 / 12.2))
    assert thruster_power(swamp, throttle) == pytest.approx(96.7, abs=0.05)
    highest = thruster_power(swamp, np.full(4, np.sqrt(13.5 / 12.2)))
    assert highest == pytest.approx(105.0, rel=0.06)  # 5.5.2, "around 105 W for a thrust of about 13.5 N"


def test_power_rises_with_the_throttle_from_the_idle_power(swamp: Boat) -> None:
    power = thruster_power(swamp, np.linspace(0.0, 1.0, 21)[:, None] * np.ones(4))
    assert np.all(np.diff(power, axis=0) > 0.0)
    assert power[0] == pytest.approx(9.404)


def test_two_packs_share_the_thrusters_by_side_and_mirror_with_them(swamp: Boat) -> None:
    throttle = np.array([0.9, 0.2, 0.4, 0.7])  # bs, bp, ss, sp
    starboard, port = pack_power(swamp, throttle)
    each = thruster_power(swamp, throttle)
    assert starboard == pytest.approx(each[0] + each[2] + 88.0)
    assert port == pytest.approx(each[1] + each[3] + 88.0)
    assert pack_power(swamp, throttle[[1, 0, 3, 2]]) == pytest.approx([port, starboard])


def test_a_thruster_amidships_draws_half_from_each_pack_and_one_pack_feeds_all(swamp: Boat) -> None:
    middle = swamp.thrusters[0].model_copy(update={"y": 0.0})
    boat = swamp.model_copy(update={"thrusters": (middle, *swamp.thrusters[1:])})
    throttle = np.array([0.8, 0.0, 0.0, 0.0])
    starboard, port = pack_power(boat, throttle)
    assert port - starboard == pytest.approx(9.404)  # idle: two thrusters to port, one to starboard
    assert swamp.battery is not None
    alone = swamp.model_copy(update={"battery": swamp.battery.model_copy(update={"packs": 1})})
    (whole,) = pack_power(alone, throttle)
    assert whole == pytest.approx(starboard + port - 88.0)


def test_range_is_the_way_until_the_first_pack_reaches_its_reserve(swamp: Boat) -> None:
    battery = swamp.battery
    assert battery is not None
    usable = float(stored_energy(battery, np.array(1.0)) - stored_energy(battery, np.array(0.1)))
    used = np.array([0.25, 0.10]) * usable
    assert range_left(swamp, used, np.array(500.0)) == pytest.approx(1500.0)
    assert range_left(swamp, 8.0 * used, np.array(500.0)) == 0.0
    assert np.isnan(range_left(swamp, used, np.array(0.0)))


def test_a_boat_without_battery_has_no_electric_figures_and_the_missing_key_is_named(tmp_path: Path) -> None:
    for name, key in (("esso_osaka", "power"), ("swamp-thesis", "power")):
        boat = load_boat(name)
        assert str(missing(boat)).endswith(key)
        with pytest.raises(UserError, match=rf"thrusters\.\w+\.{key}: is missing"):
            pack_power(boat, np.zeros(len(boat.thrusters)))
    (tmp_path / "mine.yaml").write_text("extends: swamp\nbattery: null\n")
    assert missing(load_boat(tmp_path / "mine.yaml")) == "battery"


def test_battery_and_power_leave_the_digest_of_a_boat_as_it_is(tmp_path: Path, swamp: Boat) -> None:
    (tmp_path / "mine.yaml").write_text("extends: swamp\nbattery: null\nthruster_model: {power: null}\n")
    assert boat_digest(load_boat(tmp_path / "mine.yaml")) == boat_digest(swamp)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("voltage_empty: 41.0", "voltage_empty must not be above voltage_full"),
        ("current_continuous: 16.0", "current_continuous must not be above current_peak"),
        ("packs: 3", "battery.packs"),
        ("capacity: 13.0e9", "battery.capacity: 1.3e+10 C is implausible"),
        ("depth_of_discharge: 1.5", "battery.depth_of_discharge"),
        ("volts: 12.0", "battery.volts"),
    ],
)
def test_a_battery_that_cannot_be_is_refused_by_its_key(tmp_path: Path, line: str, message: str) -> None:
    (tmp_path / "mine.yaml").write_text(f"extends: swamp\nbattery: {{{line}}}\n")
    with pytest.raises(UserError) as refused:
        load_boat(tmp_path / "mine.yaml")
    assert message in str(refused.value)
    assert "mine.yaml" in str(refused.value)
