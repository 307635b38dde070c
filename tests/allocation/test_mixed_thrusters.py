"""Allocation to thrusters that differ: a measured stern propeller and a bow jet, and what is refused."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.allocation import allocate, jets_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.drive import drive_of
from swamp_rl.physics.thrusters import effective_thrust

ROWS = [
    {"throttle": -1.0, "thrust": [-20.0, -26.0, -34.0]},
    {"throttle": 0.5, "thrust": [8.0, 4.0, -2.0]},
    {"throttle": 1.0, "thrust": [30.0, 22.0, 12.0]},
]
STERN: dict[str, Any] = {"name": "main", "kind": "fixed", "x": -0.5, "y": 0.0, "pump_time_constant": 0.1}
STERN |= {"azimuth_min": 0.0, "azimuth_max": 0.0, "thrust_table": {"speed": [0.0, 1.0, 2.0], "rows": ROWS}}
BOW: dict[str, Any] = {"name": "bow", "kind": "azimuth", "x": 0.5, "y": 0.0, "azimuth_rate": 3.0}
BOW |= {"azimuth_time_constant": 0.1, "pump_time_constant": 0.0, "thrust_quadratic": 6.0}


def mixed() -> Boat:
    keys = {"thruster_model": None, "thrusters": [STERN, BOW], "joypad": {"thrusters": ["main", "bow"]}}
    return load_boat("swamp", {**keys, "battery": None})


@pytest.mark.parametrize("wanted", [(12.0, 1.5, 0.75), (-9.0, -2.0, -1.0), (3.0, 0.0, 0.0)])
def test_a_stern_table_and_a_bow_jet_give_the_wanted_force_at_rest(
    wanted: tuple[float, float, float],
) -> None:
    boat = mixed()
    jets = jets_of(boat)
    found = allocate(jets, np.array(wanted))
    assert found.attainable
    thrust = [effective_thrust(float(found.throttle[k]), k, jets.record[0]) for k in range(2)]
    surge = thrust[0] + thrust[1] * np.cos(found.azimuth[1])
    sway = thrust[1] * np.sin(found.azimuth[1])
    assert [surge, sway, 0.5 * sway] == pytest.approx(wanted, abs=1e-3)


def test_the_mirrored_force_is_the_mirrored_command() -> None:
    jets = jets_of(mixed())
    one, other = (allocate(jets, np.array([6.0, side * 2.0, side])) for side in (1.0, -1.0))
    assert one.throttle == pytest.approx(other.throttle, abs=1e-6)
    assert one.azimuth == pytest.approx(-other.azimuth, abs=1e-6)


def test_a_rudder_beside_a_jet_is_refused_in_one_line() -> None:
    jet = {**BOW, "x": 1.2, "azimuth_min": -1.0, "azimuth_max": 1.0}
    boat = load_boat("esso_osaka", {"thrusters": {"bow": {k: v for k, v in jet.items() if k != "name"}}})
    with pytest.raises(UserError, match=r"thrusters\.bow is not a propeller with a rudder") as refused:
        drive_of(boat)
    assert "\n" not in str(refused.value)
