"""Boats without sway force: where their bow stays in the weather, and where that is refused."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.capability import capability
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.flight import in_sea
from swamp_rl.guidance.keep import keeper_for
from swamp_rl.guidance.loop import drive
from swamp_rl.guidance.servo import servo_of
from swamp_rl.guidance.weathervane import WeathervaneKeeper
from tests.support.new_boats import new_boat

pytestmark = pytest.mark.numerical

OFF = 0.1  # lengths north and east, and rad, at which a boat begins beside its station


def among(boat: Boat, current: float, wind: float) -> Boat:
    """The boat in a current to the north [m/s] and a wind from there."""
    flow = {"effect": "current", "north": current, "east": 0.0}
    return in_sea(boat, None, [flow, {"effect": "wind", "speed": wind, "from": 0.0}], 0)[0]


def strayed(sea: Boat, heading: float, seconds: float) -> float:
    """Farthest distance [lengths] from the station in the last quarter, with the bow kept at a heading."""
    keeper = WeathervaneKeeper(drive_of(sea), servo_of(sea), (0.0, 0.0), heading, sea.length)
    away = OFF * sea.length
    track = drive(sea, keeper, (away, away, heading + OFF), seconds)
    return float(np.hypot(*track[-len(track) // 4 :, :2].T).max()) / sea.length


def test_a_rudder_with_the_current_from_astern_is_refused_and_would_lose_its_station(tmp_path: Path) -> None:
    sea = among(new_boat(tmp_path, "propeller-rudder", 5.0), 0.3, 9.0)
    with pytest.raises(UserError, match="heading 0 deg: the current comes from astern"):
        keeper_for(sea, drive_of(sea), (0.0, 0.0))
    assert strayed(sea, 0.0, 240.0) > 1.0


def test_a_tanker_in_wind_alone_is_refused_and_would_lose_its_station() -> None:
    sea = among(load_boat("esso_osaka"), 0.0, 6.0)
    with pytest.raises(UserError, match="cannot turn the bow back from 5 deg"):
        keeper_for(sea, drive_of(sea), (0.0, 0.0))
    assert strayed(sea, 0.0, 240.0) > 1.0


def test_a_tanker_that_no_wind_is_too_weak_to_turn_has_a_wind_limit_of_zero() -> None:
    boat = load_boat("esso_osaka")
    assert capability(boat, drive_of(boat), directions=2).wind == pytest.approx([0.0, 0.0], abs=1e-3)


@pytest.mark.parametrize(("share", "stays"), [(0.9, True), (1.15, False)])
def test_a_tanker_holds_up_to_the_current_of_its_capability_plot(share: float, stays: bool) -> None:
    boat = load_boat("esso_osaka")
    strongest = float(capability(boat, drive_of(boat), directions=1).current[0])
    assert (strayed(among(boat, -share * strongest, 0.0), 0.0, 240.0) < 1.0) == stays


@pytest.mark.parametrize("wind_from", [90.0, 270.0])
def test_a_rudder_that_the_flow_from_the_side_turns_holds_where_all_of_the_force_is_needed(
    tmp_path: Path, wind_from: float
) -> None:
    boat = new_boat(tmp_path, "propeller-rudder", 5.0)
    given = [
        {"effect": "current", "north": 0.2, "east": 0.0},
        {"effect": "wind", "speed": 7.0, "from": np.radians(wind_from)},
    ]
    sea = in_sea(boat, None, given, 0)[0]
    _, balance = keeper_for(sea, drive_of(sea), (0.0, 0.0))
    assert strayed(sea, balance.heading, 240.0) < 0.5


def test_a_current_and_a_wind_that_cancel_are_reported_as_such(tmp_path: Path) -> None:
    boat = new_boat(tmp_path, "twin-fixed", 2.4)
    sea = among(boat, 0.5, 8.0)
    with pytest.raises(UserError, match="oppose each other here"):
        keeper_for(sea, drive_of(sea), (0.0, 0.0))
    calm = among(boat, 0.0, 0.0)
    with pytest.raises(UserError, match="there is none here"):
        keeper_for(calm, drive_of(calm), (0.0, 0.0))
