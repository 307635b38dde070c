"""Station keeping with what is left of the thrusters: it holds where that was promised, and only there."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.allocation import Jets, jets_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import Kind
from swamp_rl.effects import parse_effects
from swamp_rl.errors import UserError
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.flight import in_sea
from swamp_rl.guidance.holding import Holding, best_holding, holding_at, steady_force
from swamp_rl.guidance.keep import keeper_for
from swamp_rl.guidance.loop import drive
from swamp_rl.guidance.one_jet import OneJetKeeper
from swamp_rl.guidance.servo import VelocityServo, inertia_of
from swamp_rl.guidance.station import Station, StationKeeper
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, YAW_RATE
from tests.support.new_boats import new_boat

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")


def among(north: float, east: float, wind: float, wind_from: float) -> Boat:
    """The boat in a current [m/s] and a wind."""
    given = [
        {"effect": "current", "north": north, "east": east},
        {"effect": "wind", "speed": wind, "from": wind_from},
    ]
    return BOAT.model_copy(update={"effects": tuple(parse_effects(given, "test", BOAT.thruster_names))})


SEA = among(-0.2, 0.1, 4.0, 0.3)
START = (0.6, -0.6, 0.4)


def strayed(boat: Boat, failed: tuple[str, ...], held: Holding, seconds: float = 90.0) -> tuple[float, float]:
    """Farthest from the station [m] and its heading [rad] in the last 30 s, begun 0.85 m and 0.4 rad away."""
    jets = jets_of(boat).without(failed)
    keeper = StationKeeper(jets, VelocityServo(inertia_of(boat)), Station(0.0, 0.0, held.heading))
    start = (START[0], START[1], held.heading + START[2])
    track = drive(boat, keeper, start, seconds, dt=0.2, failed=failed)[-150:]
    return float(np.hypot(track[:, NORTH], track[:, EAST]).max()), float(
        np.abs(track[:, HEADING] - held.heading).max()
    )


@pytest.mark.parametrize("failed", [(), ("bs",), ("bs", "bp"), ("bs", "sp"), ("bp", "sp")])
def test_it_holds_where_it_said_it_would(failed: tuple[str, ...]) -> None:
    held = best_holding(SEA, jets_of(SEA).without(failed))
    assert held.holds
    assert held.reason.startswith("can hold")
    assert max(strayed(SEA, failed, held)) < 0.02


def test_in_still_water_no_force_is_needed() -> None:
    calm = among(0.0, 0.0, 0.0, 0.0)
    assert holding_at(calm, jets_of(calm), 0.0).reason == "can hold at heading 0 deg: no force is needed"


def test_where_it_said_it_could_not_it_strays_or_is_turned_away() -> None:
    boat = among(0.0, 0.4, 0.0, 0.0)
    held = holding_at(boat, jets_of(boat).without(["bs", "bp"]), 0.0)
    assert not held.holds
    assert "cannot hold at heading 0 deg" in held.reason
    assert max(strayed(boat, ("bs", "bp"), held)) > 0.5


def test_the_steady_force_is_what_would_stop_the_boat_from_being_carried_off() -> None:
    for heading in (0.3, 2.0, -1.2):
        params = parameters(SEA)
        state = initial_state(params, np.array([[0.0, 0.0, heading]]))
        dt = 1e-4
        step(state, params, tank(SEA), np.zeros((1, 8)), np.zeros(1, np.uint64), dt, 1)
        pushed = inertia_of(SEA) * state[0, SURGE : YAW_RATE + 1] / dt
        assert steady_force(SEA, heading) == pytest.approx(-pushed, rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("left", ["bs", "sp"])
def test_the_last_jet_holds_the_place_at_a_heading_of_its_own(left: str) -> None:
    failed = tuple(name for name in BOAT.thruster_names if name != left)
    jets = jets_of(SEA).without(failed)
    held = best_holding(SEA, jets)
    k = BOAT.thruster_names.index(left)
    assert held.needed[2] == pytest.approx(jets.x[k] * held.needed[1] - jets.y[k] * held.needed[0], abs=1e-6)
    keeper = OneJetKeeper(SEA, jets, (0.0, 0.0), held)
    track = drive(SEA, keeper, (0.4, -0.4, held.heading + 0.3), 150.0, dt=0.2, failed=failed)
    assert np.hypot(track[-150:, NORTH], track[-150:, EAST]).max() < 0.05


def test_the_last_jet_finds_its_heading_where_the_current_is_not_as_believed() -> None:
    believed, failed = among(-0.25, 0.05, 4.0, 0.3), ("bs", "bp", "ss")
    jets = jets_of(believed).without(failed)
    held = best_holding(believed, jets)
    keeper = OneJetKeeper(believed, jets, (0.0, 0.0), held)
    track = drive(SEA, keeper, (0.0, 0.0, held.heading), 300.0, dt=0.2, failed=failed)
    assert np.hypot(track[-150:, NORTH], track[-150:, EAST]).max() < 0.05
    assert abs(track[-1, HEADING] - held.heading) > math.radians(2)


def test_whoever_can_hold_is_found_and_else_the_reason_is_given() -> None:
    jets = jets_of(SEA)
    keeper, held = keeper_for(SEA, jets.without(["bs"]), (1.0, 2.0))
    assert isinstance(keeper, StationKeeper)
    assert keeper.station == Station(1.0, 2.0, held.heading)
    keeper, _ = keeper_for(SEA, jets.without(["bs", "bp", "ss"]), (0.0, 0.0))
    assert isinstance(keeper, OneJetKeeper)
    with pytest.raises(UserError, match=r"cannot hold at heading 0 deg: .* choose another heading"):
        keeper_for(among(0.0, 0.8, 0.0, 0.0), jets, (0.0, 0.0), heading=0.0)
    with pytest.raises(UserError, match="no force along that line"):
        keeper_for(SEA, jets.without(BOAT.thruster_names), (0.0, 0.0))


def test_a_boat_that_cannot_hold_is_told_only_what_it_can_change(tmp_path: Path) -> None:
    lame = in_current(new_boat(tmp_path, "twin-fixed", 2.4), -0.2, 0.1)
    jets = drive_of(lame)
    assert isinstance(jets, Jets)
    with pytest.raises(UserError, match="use a second thruster"):
        keeper_for(lame, jets.without(["port"]), (0.0, 0.0))
    with pytest.raises(UserError, match=r"choose a place with less current and wind$"):
        keeper_for(in_current(BOAT, 2.0, 0.0), jets_of(BOAT), (0.0, 0.0))
    with pytest.raises(UserError, match=r"or use more thrusters$"):
        keeper_for(in_current(BOAT, 2.0, 0.0), jets_of(BOAT).without(["bs"]), (0.0, 0.0))


def test_a_heading_just_below_a_full_turn_is_printed_as_north() -> None:
    assert "at heading 0 deg" in Holding(math.radians(359.9), np.zeros(3), 2.0).reason


def test_the_last_jet_must_be_allowed_to_push_where_the_balance_wants_it() -> None:
    failed = ["bp", "ss", "sp"]
    free = best_holding(SEA, jets_of(SEA).without(failed))
    direction = math.atan2(free.needed[1], free.needed[0])
    barred = jets_of(SEA, failed, forbidden={"bs": [(direction - 0.3, direction + 0.3)]})
    other = best_holding(SEA, barred)
    assert not math.isclose(other.heading, free.heading)
    assert other.margin < free.margin


def test_a_gust_is_counted_before_the_promise() -> None:
    jets = jets_of(SEA).without(["bs", "bp"])
    given = parse_effects(
        [{"effect": "gusts", "speed_std": 2.5, "direction_std": 0.1}], "test", BOAT.thruster_names
    )
    gusty = SEA.model_copy(update={"effects": SEA.effects + tuple(given)})
    steady, blown = holding_at(SEA, jets, 1.0), holding_at(gusty, jets, 1.0)
    harder = holding_at(among(-0.2, 0.1, 9.0, 0.3), jets, 1.0)
    assert blown.margin == pytest.approx(harder.margin)
    assert blown.margin < steady.margin
    assert blown.needed == pytest.approx(steady.needed)


def test_one_jet_in_still_water_is_said_to_have_nothing_to_lie_against() -> None:
    jets = jets_of(BOAT).without(["bs", "bp", "ss"])
    held = best_holding(BOAT, jets)
    assert not held.holds
    assert "without current or wind" in held.reason
    with pytest.raises(UserError, match="current or wind; give it a second jet"):
        OneJetKeeper(BOAT, jets, (0.0, 0.0), held)


def in_current(boat: Boat, north: float, east: float) -> Boat:
    return in_sea(boat, None, [{"effect": "current", "north": north, "east": east}], 0)[0]


@pytest.mark.parametrize("kind", ["waterjet", "outboard"])
def test_one_jet_of_a_large_boat_is_brought_back_to_its_place_in_a_current(
    tmp_path: Path, kind: Kind
) -> None:
    sea = in_current(new_boat(tmp_path, kind, 5.0), -0.3, 0.6)
    keeper, held = keeper_for(sea, drive_of(sea), (0.0, 0.0))
    track = drive(sea, keeper, (0.0, 0.0, held.heading), 90.0, dt=0.2)[-150:]
    assert np.hypot(track[:, NORTH], track[:, EAST]).max() < 0.05


def test_the_margin_counts_what_the_jets_lose_in_the_current() -> None:
    sea = in_current(BOAT, 1.5, 0.0)
    with pytest.raises(UserError, match=r"the thrusters give 0\.\d+ times that"):
        keeper_for(sea, jets_of(sea), (0.0, 0.0))


@pytest.mark.parametrize("kind", ["twin-fixed", "propeller-rudder", "waterjet"])
def test_a_heading_that_the_drive_cannot_choose_is_refused(tmp_path: Path, kind: Kind) -> None:
    sea = in_current(new_boat(tmp_path, kind, 5.0), 0.5, 0.0)
    with pytest.raises(UserError, match=r"current and wind set the heading .* leave the heading out"):
        keeper_for(sea, drive_of(sea), (0.0, 0.0), heading=1.5)
