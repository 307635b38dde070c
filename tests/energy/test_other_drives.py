"""Power of propellers, tables and ships: by the torque, as measured, and missions flown with them."""

import math
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.energy import pack_power, thruster_power
from swamp_rl.energy.best_range import energy_per_metre_at
from swamp_rl.energy.fly import fly
from swamp_rl.energy.mission import Mission
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.captive import thrust_at_rest
from swamp_rl.simulator.state import EAST, NORTH

NO_CURVE = dict.fromkeys(
    ("thrust_linear", "thrust_quadratic", "astern_linear", "astern_quadratic", "advance_loss"), None
)
OPEN_WATER = {"kind": "linear", "bollard_coefficient": 0.45, "null_advance": 1.05}
PROPELLER = {"diameter": 0.08, "revolutions_max": 25.0, "torque_coefficient": 0.05, "open_water": OPEN_WATER}
MEASURED = {"throttle": [0.0, 0.5, 1.0], "power": [2.0, 10.0, 60.0]}
SHAFT = {"idle": 3.0, "efficiency": 0.6}
PACK = {"voltage_full": 26.0, "voltage_empty": 20.0, "capacity": 360000.0, "depth_of_discharge": 0.8}
PACK |= {"current_continuous": 40.0, "current_peak": 60.0, "hotel_power": 50.0, "packs": 1}


def swamp_with(power: dict[str, Any]) -> Boat:
    """SWAMP with propellers of that power, no key of which is SWAMP's own."""
    gone = dict.fromkeys(("idle", "coefficient"), None)
    return load_boat("swamp", {"thruster_model": {**NO_CURVE, "propeller": PROPELLER, "power": gone | power}})


def ship() -> Boat:
    """The pond's ship with a measured table and a battery."""
    return load_boat("esso_osaka", {"thrusters": {"main": {"power": MEASURED}}, "battery": PACK})


def test_a_propeller_draws_the_power_of_its_shaft_over_the_efficiency() -> None:
    throttle = np.array([[0.0, 0.4, 1.0, 0.2]])
    n = 25.0 * throttle
    known = 3.0 + 2.0 * math.pi * n * (0.05 * 1025.0 * n**2 * 0.08**5) / 0.6
    assert thruster_power(swamp_with(SHAFT), throttle) == pytest.approx(known, rel=1e-12)


def test_a_measured_table_is_linear_between_its_points_and_alike_astern() -> None:
    power = thruster_power(ship(), np.array([[0.0], [0.25], [0.5], [1.0]]) * ship().thrusters[0].throttle_max)
    assert power[:, 0] == pytest.approx([2.0, 6.0, 10.0, 60.0])
    astern = thruster_power(ship(), np.array([[0.5 * ship().thrusters[0].throttle_min]]))
    assert astern[0, 0] == pytest.approx(10.0)


def test_a_ships_power_curve_takes_the_thrust_at_rest_that_the_captive_trial_measures() -> None:
    given = {"main": {"power": {"idle": 1.0, "coefficient": 2.0}}}
    boat = load_boat("esso_osaka", {"thrusters": given, "battery": PACK})
    for n in (8.0, -6.0):
        thrust = abs(thrust_at_rest(boat, np.array([0.0, n])))
        assert thruster_power(boat, np.array([n]))[0] == pytest.approx(1.0 + 2.0 * thrust**1.5, rel=1e-9)


def test_a_ship_flies_a_mission_on_its_battery() -> None:
    legs = [{"speed": 0.4, "duration_s": 120.0, "course_deg": 20.0}]
    flight = fly(ship(), Mission.model_validate({"name": "m", "boat": "esso_osaka", "legs": legs}), "m.yaml")
    level = flight.states[-1, 10]
    assert flight.speed[-1] == pytest.approx(0.4, abs=0.02)
    assert flight.packs.power[-1, 0] == pytest.approx(
        float(pack_power(ship(), np.array([level]))[0]), rel=0.02
    )
    assert flight.packs.power[-1, 0] > 52.0
    assert flight.packs.charge[-1, 0] < 1.0


def test_propellers_with_power_have_an_energy_per_metre() -> None:
    boat = swamp_with(SHAFT)
    assert boat.battery is not None
    assert energy_per_metre_at(boat, 0.8) > 2.0 * boat.battery.hotel_power / 0.8


def test_power_leaves_the_digest_of_a_ship_as_it_is() -> None:
    assert boat_digest(ship()) == boat_digest(load_boat("esso_osaka"))


@pytest.mark.parametrize(
    ("power", "message"),
    [
        ({"throttle": [0.0, 1.0], "power": [1.0]}, "power.power: must have 2 or more entries"),
        ({"throttle": [0.1, 1.0], "power": [1.0, 40.0]}, "throttle must increase from 0 to 1"),
        ({"idle": 1.0, "efficiency": 1.2}, "power.efficiency"),
        ({"throttle": [0.0, 1.0], "power": [1.0, 1e6]}, "power / thrust at full throttle"),
    ],
)
def test_a_wrong_power_is_refused_with_its_key(power: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match="swamp") as refused:
        swamp_with(power)
    assert message in str(refused.value)


def test_power_by_torque_without_a_torque_coefficient_is_refused() -> None:
    without = {key: value for key, value in PROPELLER.items() if key != "torque_coefficient"}
    gone = dict.fromkeys(("idle", "coefficient"), None)
    keys = {**NO_CURVE, "propeller": without, "power": gone | SHAFT}
    with pytest.raises(UserError, match=r"needs propeller\.torque_coefficient"):
        load_boat("swamp", {"thruster_model": keys})


def test_a_ship_turns_from_leg_to_leg_within_its_own_length() -> None:
    legs = [{"speed": 0.4, "waypoints": [[25.0, 0.0], [25.0, 25.0]]}]
    flight = fly(ship(), Mission.model_validate({"name": "m", "boat": "esso_osaka", "legs": legs}), "m.yaml")
    north, east = flight.states[:, NORTH], flight.states[:, EAST]
    assert np.abs(north[east > 12.5] - 25.0).max() < ship().length
