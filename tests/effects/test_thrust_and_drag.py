"""Dead bands, efficiency curves, linear damping and lopsided drag against closed forms."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.effects import LIBRARY, apply_effects, parse_effects
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import SURGE
from tests.support.boats import forces_on_hull
from tests.support.effects import (
    BOAT,
    DT,
    SWAY_MASS,
    YAW_INERTIA,
    at_once,
    lively,
    record,
    track,
)


def test_a_dead_band_gives_nothing_below_and_rises_from_zero_to_the_full_thrust() -> None:
    with_band, without = (
        record({"effect": "throttle_dead_band", "thruster": "bs", "below": 0.25})[0],
        record()[0],
    )
    thrusts = np.array([effective_thrust(float(p), 0, with_band) for p in np.linspace(0.0, 1.0, 2001)])
    assert (thrusts[:501] == 0.0).all()
    assert (np.diff(thrusts[501:]) > 0.0).all()
    assert np.diff(thrusts).max() < 0.03  # no step at the band's end
    assert thrusts[-1] == effective_thrust(1.0, 0, without)
    shifted = [effective_thrust((p - 0.25) / 0.75, 0, without) for p in (0.4, 0.7, 0.9)]
    assert [effective_thrust(p, 0, with_band) for p in (0.4, 0.7, 0.9)] == pytest.approx(shifted, rel=1e-12)
    assert effective_thrust(0.2, 1, with_band) == effective_thrust(0.2, 1, without)


def test_an_efficiency_curve_multiplies_the_thrust_by_a_line_between_its_knots() -> None:
    factors = {"at_30": 0.6, "at_60": 0.9, "at_100": 1.2}
    curved = record({"effect": "thruster_efficiency_curve", "thruster": "all"} | factors)[0]
    throttles = np.linspace(0.05, 1.0, 39)
    ratio = [effective_thrust(p, 2, curved) / effective_thrust(p, 2, record()[0]) for p in throttles]
    assert ratio == pytest.approx(np.interp(throttles, [0.3, 0.6, 1.0], [0.6, 0.9, 1.2]), rel=1e-12)


def test_a_scale_of_the_resistance_leaves_linear_drag_and_the_drag_across_as_they_are() -> None:
    linear, scaled = {"effect": "linear_drag", "coefficient": 5.0}, {"effect": "resistance", "scale": 1.4}
    for u, v, r in ((0.6, 0.0, 0.0), (0.5, 0.2, 0.3)):
        plain, fouled = (
            forces_on_hull(BOAT, record(*more)[0], u, v, r) for more in ((linear,), (linear, scaled))
        )
        without, tank_alone = (forces_on_hull(BOAT, record(*more)[0], u, v, r) for more in ((), (scaled,)))
        assert fouled[0] - plain[0] == pytest.approx(tank_alone[0] - without[0], rel=1e-9)
        assert fouled[1] == plain[1]
    assert forces_on_hull(BOAT, record(scaled)[0], 0.6, 0.0, 0.0)[0] == pytest.approx(
        1.4 * forces_on_hull(BOAT, record()[0], 0.6, 0.0, 0.0)[0], rel=1e-9
    )
    assert "linear drag and the drag across keep their size" in LIBRARY["resistance"].description


def test_an_even_efficiency_curve_is_a_gain() -> None:
    even = {
        "effect": "thruster_efficiency_curve",
        "thruster": "bs",
        "at_30": 0.7,
        "at_60": 0.7,
        "at_100": 0.7,
    }
    gain = {"effect": "thruster_gain", "thruster": "bs", "gain": 0.7}
    assert track(lively(), even) == pytest.approx(track(lively(), gain), abs=1e-12)


def test_a_propeller_obeys_dead_band_and_efficiency_in_shares_of_its_most_revolutions() -> None:
    ship = load_boat("esso_osaka")
    most = ship.thrusters[0].revolutions_max
    name = ship.thruster_names[0]

    def speed(share: float, *entries: dict[str, Any]) -> float:
        params = parameters(ship)
        apply_effects(params, parse_effects(list(entries), "test", ship.thruster_names), ship.thruster_names)
        command = np.tile([0.0, share * most], (100, 1))
        start = initial_state(params, np.zeros((1, 3)))
        end = simulate(params, tank(ship), start, command[None], np.zeros(1, np.uint64), DT, 2)[0, -1]
        return float(end[SURGE])

    band = {"effect": "throttle_dead_band", "thruster": name, "below": 0.25}
    assert speed(0.2, band) == 0.0
    assert speed(0.7, band) == pytest.approx(speed(0.6), rel=1e-9)
    curve = {"effect": "thruster_efficiency_curve", "thruster": name, "at_30": 0.5, "at_60": 0.8}
    gain = {"effect": "thruster_gain", "thruster": name, "gain": 0.65}
    assert speed(0.45, curve) == pytest.approx(speed(0.45, gain), rel=1e-3)  # while the shaft speeds up, less


def test_linear_damping_at_zero_speed_takes_sway_and_yaw_by_their_coefficients() -> None:
    damped = [{"effect": f"linear_{motion}_damping", "coefficient": 5.0} for motion in ("sway", "yaw")]
    v, r = 1e-4, 2e-4  # where squares vanish
    extra = at_once(*damped, velocity=(0, v, r)) - at_once(velocity=(0, v, r))
    assert extra == pytest.approx([0.0, -5.0 * v / SWAY_MASS, -5.0 * r / YAW_INERTIA], rel=1e-3, abs=1e-9)


def test_asymmetric_drag_astern_is_a_scaled_resistance_and_to_port_a_scaled_drag() -> None:
    odd = {"effect": "drag_asymmetry", "astern": 1.7, "port": 1.4}
    scaled = [{"effect": "resistance", "scale": 1.7}, {"effect": "sway_drag", "scale": 1.4}]
    there = forces_on_hull(BOAT, record(odd)[0], -0.6, -0.2, 0.0)
    assert there == pytest.approx(forces_on_hull(BOAT, record(*scaled)[0], -0.6, -0.2, 0.0), rel=1e-12)
    plain = forces_on_hull(BOAT, record()[0], 0.6, 0.2, 0.3)
    assert forces_on_hull(BOAT, record(odd)[0], 0.6, 0.2, 0.3) == plain
    for u, v in ((1e-7, 0.3), (0.3, 1e-7)):  # continuous where it sets in
        sides = [forces_on_hull(BOAT, record(odd)[0], sign * u, v, 0.3) for sign in (-1, 1)]
        sides += [forces_on_hull(BOAT, record(odd)[0], u, sign * v, 0.3) for sign in (-1, 1) if v < 1e-6]
        assert np.ptp(sides[-2:], axis=0) == pytest.approx(0.0, abs=1e-5)


def test_a_boat_lopsided_to_the_other_side_has_the_mirrored_sway_force() -> None:
    to_port = record({"effect": "drag_asymmetry", "port": 1.6})[0]
    larger, less_to_port = {"effect": "sway_drag", "scale": 1.6}, {"effect": "drag_asymmetry", "port": 0.625}
    to_starboard = record(larger, less_to_port)[0]
    for v in (0.2, -0.2):
        one = forces_on_hull(BOAT, to_port, 0.7, v, 0.3)[1]
        assert forces_on_hull(BOAT, to_starboard, 0.7, -v, -0.3)[1] == pytest.approx(-one, rel=1e-12)
