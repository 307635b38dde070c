"""The simulator gives the figures that an independent program got from the same equations, and the tank's."""

import math

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.thrusters import bollard_thrust
from swamp_rl.simulator import parameters
from swamp_rl.simulator.state import EAST, HEADING, SURGE, SWAY, YAW_RATE
from tests.support.boats import Array, commands, forces_on_hull, track

FINE = {"dt": 0.01, "substeps": 1}


HEAVY = load_boat("swamp-thesis")
# As the reference program had it: mass and draught of the sea trials, added masses of the full load.
LIGHT = Boat.model_validate(
    HEAVY.model_dump(exclude={"effects"})
    | {"name": "light", "mass": 48.0, "draught": 0.115}
    | {"hull": HEAVY.hull.model_dump() | {"c_d": -0.0591 * 1.24 / 0.115 + 1.848}}
)


@pytest.fixture(params=[HEAVY, LIGHT], ids=["58 kg", "48 kg"])
def boat(request: pytest.FixtureRequest) -> Boat:
    return request.param


def of(boat: Boat, heavy: float, light: float) -> float:
    return heavy if boat is HEAVY else light


def straight_speed(boat: Boat, throttle: tuple[float, float, float, float]) -> float:
    return float(track(boat, commands(0, 0, throttle, 12_000), **FINE)[-1, SURGE])


def circle(boat: Boat, azimuth: float) -> Array:
    """A turn to starboard with bow +, stern - that azimuth, after the 2 s run-up from rest of the figures."""
    ahead = track(boat, commands(0, 0, (0.6,) * 4, 200), **FINE)[-1:].copy()
    ahead[:, :HEADING] = 0.0
    return track(boat, commands(azimuth, -azimuth, (0.6,) * 4, 12_000), start=ahead, **FINE)


def test_two_bow_thrusters_reach_the_speed_of_the_reference(boat: Boat) -> None:
    assert straight_speed(boat, (1, 1, 0, 0)) == pytest.approx(of(boat, 1.16, 1.20), abs=0.005)


def test_four_thrusters_at_60_percent_reach_the_speed_of_the_reference(boat: Boat) -> None:
    assert straight_speed(boat, (0.6,) * 4) == pytest.approx(of(boat, 0.96, 0.99), abs=0.005)


def test_the_maximum_speed_is_that_of_the_reference(boat: Boat) -> None:
    assert straight_speed(boat, (1,) * 4) == pytest.approx(of(boat, 1.44, 1.49), abs=0.005)


@pytest.mark.parametrize(
    ("azimuth", "tactical", "speed"), [(30, (6.9, 6.5), (0.81, 0.83)), (60, (2.7, 2.8), (0.31, 0.27))]
)
def test_the_turning_circle_is_that_of_the_reference(
    boat: Boat, azimuth: float, tactical: tuple[float, float], speed: tuple[float, float]
) -> None:
    turn = circle(boat, azimuth)
    half_way = int(np.argmax(turn[:, HEADING] >= np.pi))
    assert turn[half_way, EAST] == pytest.approx(of(boat, *tactical), abs=0.05)
    assert np.hypot(turn[-1, SURGE], turn[-1, SWAY]) == pytest.approx(of(boat, *speed), abs=0.0055)


def test_the_steady_diameter_at_60_degrees_is_that_of_the_reference(boat: Boat) -> None:
    last = circle(boat, 60)[-1]
    diameter = 2.0 * np.hypot(last[SURGE], last[SWAY]) / last[YAW_RATE]
    assert diameter == pytest.approx(of(boat, 1.6, 1.1), abs=0.05)


def zigzag_first_overshoot(boat: Boat, throttle: float) -> float:
    """20/20 zig-zag in degrees, bow azimuth +, stern -, from steady straight running."""
    limit = np.radians(20.0)
    state = track(boat, commands(0, 0, (throttle,) * 4, 600))[-1:].copy()
    state[:, : HEADING + 1] = 0.0
    side, headings = 1.0, []
    for _ in range(600):
        azimuth = 20.0 * side
        state = track(boat, commands(azimuth, -azimuth, (throttle,) * 4, 1), start=state)[-1:]
        headings.append(state[0, HEADING])
        if side > 0 and headings[-1] >= limit:
            side = -1.0
        if side < 0 and headings[-1] < headings[-2]:
            return float(np.degrees(max(headings)) - 20.0)
    raise AssertionError("no overshoot within a minute")


def test_the_zigzag_overshoot_is_that_of_the_reference() -> None:
    assert zigzag_first_overshoot(HEAVY, 0.9) == pytest.approx(9.9, abs=0.1)
    assert zigzag_first_overshoot(HEAVY, 0.6) == pytest.approx(12.5, abs=0.1)
    assert zigzag_first_overshoot(LIGHT, 0.6) == pytest.approx(13.4, abs=0.1)


def test_the_towing_tank_is_reproduced_at_its_own_points_within_one_percent() -> None:
    boat = load_boat("swamp")
    params = parameters(boat)
    params["water_density"] = 1001.0
    for curve in boat.resistance.table:
        params["depth_over_draught"] = curve.h_over_t
        for speed, resistance in zip(curve.speed, curve.resistance, strict=True):
            surge, sway, yaw = forces_on_hull(boat, params[0], speed, 0.0, 0.0)
            assert -surge == pytest.approx(resistance, rel=0.01)
            assert sway == yaw == 0.0


def test_resistance_between_two_tested_depths_lies_between_theirs() -> None:
    boat = load_boat("swamp")
    params = parameters(boat)

    def drag(depth: float) -> float:
        params["depth_over_draught"] = depth
        return -forces_on_hull(boat, params[0], 1.0, 0.0, 0.0)[0]

    assert drag(9.0) == drag(50.0) < drag(4.0) < drag(3.0) < drag(2.5) < drag(1.5)
    # 1/R is linear in draught over depth: half-way between 1/2.5 and 1/4 is 1/3.0769
    half_way = 2.0 / (1.0 / drag(2.5) + 1.0 / drag(4.0))
    assert drag(1.0 / (0.5 / 2.5 + 0.5 / 4.0)) == pytest.approx(half_way, rel=1e-12)


def test_a_depth_left_out_of_the_table_comes_back_as_well_as_the_document_says() -> None:
    boat, given = load_boat("swamp"), load_boat("swamp").resistance
    for left_out, stated in ((2.0, 0.10), (2.5, 0.09), (4.0, 0.09)):
        (curve,) = (curve for curve in given.table if curve.h_over_t == left_out)
        rest = tuple(other for other in given.table if other is not curve)
        without = boat.model_copy(update={"resistance": given.model_copy(update={"table": rest})})
        params = parameters(without)
        params["water_density"], params["depth_over_draught"] = 1001.0, left_out
        back = np.array([-forces_on_hull(without, params[0], u, 0.0, 0.0)[0] for u in curve.speed])
        off = math.sqrt(float(np.mean((back / np.array(curve.resistance) - 1.0) ** 2)))
        assert off == pytest.approx(stated, abs=0.01)


@pytest.mark.parametrize(("percent", "thrust"), [(30, 1.1), (50, 3.1), (70, 6.0), (85, 8.8), (100, 12.2)])
def test_bollard_thrust_is_that_of_table_5_5(percent: int, thrust: float) -> None:
    p = parameters(load_boat("swamp"))[0]
    assert bollard_thrust(percent / 100.0, 0, p) == pytest.approx(thrust, abs=0.06)
