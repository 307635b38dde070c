"""Following curves and vehicles, and holding by every drive, in the simulator."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.guidance.capability import capability
from swamp_rl.guidance.curve import Curve, joined
from swamp_rl.guidance.curve_following import BehindVehicle, CurveFollower, SteadyPace
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.flight import Flight, flown, in_sea
from swamp_rl.guidance.holding import Holding, in_flow
from swamp_rl.guidance.keep import keeper_for
from swamp_rl.guidance.loop import drive
from swamp_rl.guidance.path_file import arc, load_path
from swamp_rl.guidance.servo import servo_of
from swamp_rl.guidance.station import Station, StationKeeper
from swamp_rl.guidance.track_errors import along_and_across, spread
from swamp_rl.simulator.reference import reference_of
from tests.support.new_boats import new_boat

pytestmark = pytest.mark.numerical


def follow(boat: Boat, curve: Curve, speed: float, sea: list[dict[str, object]] | None = None) -> Flight:
    """From rest at the start of the curve."""
    at_sea, _, _ = in_sea(boat, None, sea or [], 0)
    pace = SteadyPace(speed, curve.length)
    follower = CurveFollower(drive_of(boat), servo_of(boat), curve, pace, boat.length)
    pose = (float(curve.places[0, 0]), float(curve.places[0, 1]), float(curve.course[0]))
    return flown(at_sea, follower, pose, 3.0 * curve.length / speed)


@pytest.mark.parametrize("name", ["eight", "river"])
def test_swamp_stays_within_half_a_length_of_a_curve_in_a_current(name: str) -> None:
    boat, path = load_boat("swamp"), load_path(name)[0]
    sea = [{"effect": "current", "north": 0.0, "east": 0.2}]
    flight = follow(boat, path.curve(), path.speed, sea)
    errors = spread(along_and_across(path.curve(), flight.track, boat.length)[:, 1])
    assert flight.completed
    assert errors["max"] < 0.5 * boat.length
    assert errors["mean"] < errors["rms"] < errors["quantile_95"] < errors["max"]


def test_an_eight_mirrors_itself_from_its_first_circle_to_its_second() -> None:
    boat, path = load_boat("swamp"), load_path("eight")[0]
    curve = path.curve()
    flight = follow(boat, curve, path.speed)
    found = along_and_across(curve, flight.track, boat.length)
    quarter = [(0.25 < a / curve.length < 0.45, 0.75 < a / curve.length < 0.95) for a in found[:, 0]]
    first, second = (found[[pair[i] for pair in quarter], 1].mean() for i in (0, 1))
    assert first == pytest.approx(-second, abs=0.05)


def test_fixed_thrusters_at_full_thrust_still_turn_the_boat_onto_its_path(tmp_path: Path) -> None:
    boat = new_boat(tmp_path, "twin-fixed", 5.0)
    straight = np.zeros(60)
    line = np.stack([np.linspace(0.0, 15.0 * boat.length, 60), straight], axis=1)
    bend = arc(line[-1], 0.0, 5.0 * boat.length, math.radians(-150.0))
    curve = joined([(line, straight, straight), bend])
    flight = follow(boat, curve, reference_of(boat).speed)
    assert flight.completed
    assert np.abs(along_and_across(curve, flight.track, boat.length)[:, 1]).max() < boat.length


@pytest.mark.parametrize("kind", ["azimuth", "twin-fixed"])
def test_a_boat_does_not_weave_on_a_straight_path_at_nearly_its_top_speed(tmp_path: Path, kind: Kind) -> None:
    boat = new_boat(tmp_path, kind, 1.2)
    bend = arc(np.zeros(2), 0.0, 8.0 * boat.length, math.radians(60.0))
    end, course = bend[0][-1], float(bend[1][-1])
    ahead = np.linspace(0.0, 40.0 * boat.length, 80)[:, None] * [math.cos(course), math.sin(course)]
    curve = joined([bend, (end + ahead, np.full(80, course), np.zeros(80))])
    flight = follow(boat, curve, 0.95 * reference_of(boat).speed)
    across = along_and_across(curve, flight.track, boat.length)[:, 1]
    assert flight.completed
    assert np.abs(across[-len(across) // 4 :]).max() < 0.02 * boat.length


def test_a_boat_follows_a_vehicle_at_its_distance_on_its_way() -> None:
    boat, path = load_boat("swamp"), load_path("river")[0]
    curve, time = path.curve(), np.arange(0.0, 120.0, 0.1)
    way = np.minimum(0.7 * time, 70.0)
    pace = BehindVehicle(time, way, 6.0, reference_of(boat).speed)
    follower = CurveFollower(drive_of(boat), servo_of(boat), curve, pace, boat.length)
    flight = flown(boat, follower, (0.0, 0.0, 0.0), 200.0)
    along = along_and_across(curve, flight.track, boat.length)
    gap = np.interp(flight.time, time, way) - along[:, 0]
    under_way = (flight.time > 40.0) & (flight.time < 95.0)
    assert gap[under_way] == pytest.approx(np.full(int(under_way.sum()), 6.0), abs=0.6)
    assert flight.completed
    assert np.abs(along[:, 1]).max() < boat.length


def test_a_vehicle_outruns_a_boat_by_what_it_makes_good_above_its_top_speed() -> None:
    time = np.arange(0.0, 60.0, 0.1)
    speed = np.select([time < 20.0, time < 40.0], [0.5, 1.3], 0.2)
    way = np.concatenate([[0.0], np.cumsum(0.1 * speed[:-1])])
    lost, mean = BehindVehicle(time, way, 5.0, 1.0).outrun()
    assert (lost, mean) == pytest.approx((0.3 * 20.0, 1.3))
    assert BehindVehicle(time, way, 5.0, 1.3).outrun()[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_boats_of_every_kind_hold_a_place_in_a_current(tmp_path: Path, kind: Kind) -> None:
    boat = new_boat(tmp_path, kind, 1.2)
    top = reference_of(boat).speed
    sea, _, _ = in_sea(boat, None, [{"effect": "current", "north": -0.1 * top, "east": 0.15 * top}], 0)
    keeper, balance = keeper_for(sea, drive_of(boat), (0.0, 0.0))
    track = drive(sea, keeper, (0.1, -0.1, balance.heading), 120.0)
    assert np.hypot(track[-300:, 0], track[-300:, 1]).max() < boat.length


def test_a_tanker_holds_with_its_bow_in_current_and_wind() -> None:
    boat = load_boat("esso_osaka")
    given = [
        {"effect": "wind", "speed": 3.0, "from": 0.5},
        {"effect": "current", "north": -0.05, "east": 0.08},
    ]
    sea, _, _ = in_sea(boat, None, given, 0)
    keeper, balance = keeper_for(sea, drive_of(boat), (0.0, 0.0))
    assert balance.needed[1] == pytest.approx(0.0, abs=1e-6)
    track = drive(sea, keeper, (0.3 * boat.length, -0.3 * boat.length, balance.heading + 0.2), 400.0)
    assert np.hypot(track[-500:, 0], track[-500:, 1]).max() < 0.5 * boat.length


@pytest.mark.parametrize(("share", "stays"), [(0.92, True), (1.25, False)])
@pytest.mark.parametrize("direction", [0, 3, 7])
def test_what_the_capability_plot_says_is_held_is_held_in_simulation(
    direction: int, share: float, stays: bool
) -> None:
    boat = load_boat("swamp")
    jets, directions = drive_of(boat), 12
    angle = 2.0 * math.pi * direction / directions
    strongest = share * float(capability(boat, jets, directions=directions).current[direction])
    given = [
        {"effect": "current", "north": -strongest * math.cos(angle), "east": -strongest * math.sin(angle)}
    ]
    sea, _, _ = in_sea(boat, None, given, 0)
    keeper = StationKeeper(jets, servo_of(boat), Station(0.0, 0.0, 0.0), length=boat.length)
    track = drive(sea, keeper, (0.0, 0.0, 0.0), 90.0)
    held = np.hypot(track[-100:, 0], track[-100:, 1]).max() < 1.0 and np.abs(track[-100:, 2]).max() < 0.3
    assert held == stays


def test_capability_is_mirrored_and_falls_where_jets_fail_or_wind_adds() -> None:
    boat = load_boat("swamp")
    jets = drive_of(boat)
    whole = capability(boat, jets, directions=8)
    for values in (whole.current, whole.wind):
        assert values[1:4] == pytest.approx(values[:4:-1], rel=1e-3)
    lame = capability(boat, jets.without(["bs"]), directions=8)
    assert (lame.wind <= whole.wind + 1e-6).all() and lame.wind[2] < 0.9 * whole.wind[2]
    windy = capability(boat, jets, wind=8.0, directions=8)
    assert (windy.current < whole.current).all()


def test_jets_lose_thrust_to_the_flow_as_the_thesis_has_it() -> None:
    jets = drive_of(load_boat("swamp"))
    speed_of_jet = math.sqrt(12.2 / (1025.0 * 0.0009))
    left = in_flow(jets, 1.0).thrust_max / jets.thrust_max
    assert left == pytest.approx(np.full(4, 1.0 - 0.86 / speed_of_jet), rel=1e-6)


def test_a_drive_without_sway_force_holds_only_from_ahead_or_astern() -> None:
    boat = load_boat("esso_osaka")
    found = capability(boat, drive_of(boat), directions=8)
    assert found.current[0] > 0.2 and found.current[1:4].max() == 0.0
    assert isinstance(
        keeper_for(
            in_sea(boat, None, [{"effect": "current", "north": -0.2, "east": 0.0}], 0)[0],
            drive_of(boat),
            (0.0, 0.0),
        )[1],
        Holding,
    )
