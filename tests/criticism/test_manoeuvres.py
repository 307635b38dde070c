"""The fixed manoeuvres: every boat does what their names say, and has none that it cannot do."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.criticism.model.manoeuvres import command_bounds, manoeuvres
from swamp_rl.simulator.state import HEADING, SURGE, SWAY, YAW_RATE
from tests.support.boats import Array, track
from tests.support.from_scratch import with_tunnel, written
from tests.support.new_boats import new_boat

DT = 0.1
TURN_ON_THE_SPOT = ("twin-fixed", "four-fixed", "azimuth", "four-azimuths")
MOVE_SIDEWAYS = ("four-fixed", "azimuth", "four-azimuths")
STEER_BY_THRUST = ("twin-fixed", "four-fixed", "four-azimuths")


@pytest.fixture(params=KINDS)
def boat(request: pytest.FixtureRequest, tmp_path: Path) -> Boat:
    """A boat of each kind of drive."""
    return new_boat(tmp_path, request.param)


def sailed(boat: Boat, name: str) -> Array:
    """(T, S) states from rest under the manoeuvre of that name."""
    return track(boat, manoeuvres(boat, DT)[name])


def test_straight_ahead_is_straight_and_ahead(boat: Boat) -> None:
    states = sailed(boat, "straight ahead, 100 %")
    assert states[-1, SURGE] > 0.0
    assert np.abs(states[:, HEADING]).max() < 1e-6


@pytest.mark.parametrize(("side", "sign"), [("starboard", 1.0), ("port", -1.0)])
def test_a_turning_circle_turns_to_the_side_of_its_name(boat: Boat, side: str, sign: float) -> None:
    states = sailed(boat, f"turning circle to {side}, 60 %")
    assert (sign * states[50:, YAW_RATE] > 0.0).all()


def test_a_zig_zag_turns_to_both_sides(boat: Boat) -> None:
    states = sailed(boat, "zig-zag, 80 %")
    assert states[:, YAW_RATE].max() > 0.0 > states[:, YAW_RATE].min()


def test_astern_makes_way_astern(boat: Boat) -> None:
    assert sailed(boat, "astern")[-1, SURGE] < 0.0


@pytest.mark.parametrize("kind", TURN_ON_THE_SPOT)
def test_a_spin_turns_to_starboard_with_little_way(tmp_path: Path, kind: Kind) -> None:
    boat = new_boat(tmp_path, kind)
    states = sailed(boat, "spin")
    assert states[-1, YAW_RATE] > 0.0
    assert np.hypot(*states[-1, [SURGE, SWAY]]) < 0.05 * boat.length * states[-1, YAW_RATE]


@pytest.mark.parametrize("kind", MOVE_SIDEWAYS)
def test_sideways_moves_to_starboard_rather_than_ahead(tmp_path: Path, kind: Kind) -> None:
    states = sailed(new_boat(tmp_path, kind), "sideways")
    assert states[-1, SWAY] > 10.0 * abs(states[-1, SURGE])


@pytest.mark.parametrize("kind", STEER_BY_THRUST)
def test_differential_thrust_turns_to_both_sides_with_thrusters_straight(tmp_path: Path, kind: Kind) -> None:
    boat = new_boat(tmp_path, kind)
    states, rows = sailed(boat, "differential thrust"), manoeuvres(boat, DT)["differential thrust"]
    assert states[:, YAW_RATE].max() > 0.0 > states[:, YAW_RATE].min()
    assert np.ptp(rows[:, : len(boat.thrusters)], axis=0).max() == 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_boat_has_no_manoeuvre_that_it_cannot_do(tmp_path: Path, kind: Kind) -> None:
    names = set(manoeuvres(new_boat(tmp_path, kind), DT))
    assert ("spin" in names) == (kind in TURN_ON_THE_SPOT)
    assert ("sideways" in names) == (kind in MOVE_SIDEWAYS)
    assert ("differential thrust" in names) == (kind in STEER_BY_THRUST)


def test_thrusters_that_do_not_reverse_do_not_go_astern(tmp_path: Path) -> None:
    assert "astern" not in manoeuvres(load_boat(written(tmp_path, "crossed")), DT)


def test_a_tunnel_thruster_rests_in_a_circle_and_pushes_in_a_spin(tmp_path: Path) -> None:
    found = manoeuvres(load_boat(with_tunnel(written(tmp_path, "twin"))), DT)
    assert not found["turning circle to port, 60 %"][:, -1].any()
    assert found["spin"][0, -1] > 0.0


def test_no_two_manoeuvres_of_a_boat_have_equal_commands(boat: Boat) -> None:
    for (one, first), (other, second) in combinations(manoeuvres(boat, DT).items(), 2):
        assert not np.array_equal(first, second), f"{one} and {other}"


def test_full_ahead_is_the_greatest_command_of_each_thruster(boat: Boat) -> None:
    count = len(boat.thrusters)
    levels = manoeuvres(boat, DT)["straight ahead, 100 %"][:, count:]
    assert (levels == [thruster.throttle_max for thruster in boat.thrusters]).all()


def test_commands_keep_the_limits_of_the_boat(boat: Boat) -> None:
    for throttle in (1.0, 0.3):
        low, high = command_bounds(boat, throttle)
        for rows in manoeuvres(boat, DT, throttle=throttle).values():
            assert (low <= rows).all() and (rows <= high).all()


def test_a_lower_throttle_keeps_what_the_names_say(boat: Boat) -> None:
    full, low = manoeuvres(boat, DT), manoeuvres(boat, DT, throttle=0.3)
    assert full.keys() == low.keys()
    levels = len(boat.thrusters)
    for name, rows in low.items():
        assert rows[:, :levels] == pytest.approx(full[name][:, :levels])
        assert rows[:, levels:] == pytest.approx(0.3 * full[name][:, levels:])
