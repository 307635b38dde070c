"""The boat as measured: its two corrections by closed form, and printed figures that had no part in a fit."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.air_and_current import current_push
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.hull import demihull_resistance
from swamp_rl.physics.propulsion import propulsion_forces
from swamp_rl.physics.resistance import piece_of, surge_resistance, towing
from swamp_rl.physics.thrusters import put_output
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.state import NORTH, SURGE, SWAY, YAW_RATE
from tests.support.boats import commands, track

HEAVY, LIGHT = load_boat("swamp"), load_boat("swamp-light")
P, TANK = parameters(HEAVY)[0], tank(HEAVY)
speeds, rates = st.floats(-1.7, 1.7), st.floats(-1.5, 1.5)


def pull(boat: Boat, throttle: float, speed: float = 0.0) -> float:
    """Thrust [N] of the four jets straight ahead at that surge speed [m/s]."""
    p = parameters(boat)[0]
    at_rest = p["thrust_quadratic"][0] * throttle**2
    jets = np.zeros((1, 4, JET))
    for k in range(4):
        put_output(at_rest, 0.0, jets, 0, k, p)
    return float(propulsion_forces(jets, 0, speed, 0.0, 0.0, p)[0])


@given(speeds, speeds, rates)
def test_two_demihulls_resist_as_two_halves_of_the_towed_hull(u: float, v: float, r: float) -> None:
    tow, half = towing(P, TANK), 0.5 * HEAVY.hull.spacing
    sides = {y: 0.5 * surge_resistance(u - r * y, v, P, TANK, tow) for y in (half, -half)}
    surge, yaw = demihull_resistance(u, v, r, P, TANK, tow)
    assert surge == pytest.approx(sum(sides.values()), rel=1e-12, abs=1e-12)
    assert yaw == pytest.approx(-sum(y * force for y, force in sides.items()), rel=1e-12, abs=1e-12)


@given(speeds, speeds, rates)
def test_the_moment_of_two_demihulls_takes_energy_and_changes_sign_with_the_turn(
    u: float, v: float, r: float
) -> None:
    tow = towing(P, TANK)
    surge, yaw = demihull_resistance(u, v, r, P, TANK, tow)
    assert surge * u + yaw * r <= 1e-12
    mirrored = demihull_resistance(u, -v, -r, P, TANK, tow)
    assert mirrored == (pytest.approx(surge, rel=1e-12), pytest.approx(-yaw, rel=1e-12, abs=1e-15))


@pytest.mark.parametrize(("throttle", "printed"), [(0.6, 17.6), (1.0, 48.8)])
def test_four_jets_pull_on_a_bollard_what_7_3_4_printed(throttle: float, printed: float) -> None:
    assert pull(HEAVY, throttle) == pytest.approx(printed, rel=0.005)


def test_a_jet_loses_thrust_by_its_advance_over_its_own_speed() -> None:
    at_rest = 12.2 * 0.7**2
    jet_speed = math.sqrt(at_rest / (1025.0 * 900e-6))
    assert pull(HEAVY, 0.7, 1.0) == pytest.approx(4 * at_rest * (1 - 0.86 * 1.0 / jet_speed), rel=1e-12)
    # printed for the tank's fresh water: 1 - t = 0.68 at 70 % and 1 m/s
    assert pull(HEAVY, 0.7, 1.0) / (4 * at_rest) == pytest.approx(0.68, abs=0.03)


@given(speeds, speeds, st.floats(-1e-6, 1e-6), st.floats(-1e-6, 1e-6))
def test_the_current_as_a_force_vanishes_with_the_current(
    u: float, v: float, ahead: float, starboard: float
) -> None:
    assert np.allclose(current_push(u, v, ahead, starboard, P), 0.0, atol=2e-3)
    assert current_push(u, v, 0.0, 0.0, P) == (0.0, 0.0, 0.0)


# Section 7.3.5 prints 'almost 9 m, almost 1 m/s' and 'under 2 m, almost 0.5 m/s'; read as steady circles.
@pytest.mark.parametrize(
    ("azimuth", "diameter", "speed"), [(30, (9.0, 0.4), (0.95, 0.05)), (60, (1.9, 0.1), (0.48, 0.02))]
)
def test_the_circles_of_the_sea_trials_come_out_within_two_of_their_errors(
    azimuth: float, diameter: tuple[float, float], speed: tuple[float, float]
) -> None:
    straight = track(LIGHT, commands(0, 0, (0.6,) * 4, 600))[-1:]
    last = track(LIGHT, commands(azimuth, -azimuth, (0.6,) * 4, 2000), start=straight)[-1]
    went = float(np.hypot(last[SURGE], last[SWAY]))
    assert 2.0 * went / last[YAW_RATE] == pytest.approx(diameter[0], abs=2 * diameter[1])
    assert went == pytest.approx(speed[0], abs=2 * speed[1])


@pytest.mark.parametrize("boat", [HEAVY, LIGHT], ids=lambda boat: boat.name)
@pytest.mark.parametrize("throttle", [0.6, 1.0])
def test_a_yaw_rate_decays_in_straight_running(boat: Boat, throttle: float) -> None:
    straight = track(boat, commands(0, 0, (throttle,) * 4, 600))[-1:].copy()
    straight[0, YAW_RATE] = math.radians(1.15)
    after = track(boat, commands(0, 0, (throttle,) * 4, 400), start=straight)[:, YAW_RATE]
    assert abs(after[-1]) < 0.35 * after[0]
    assert np.all(np.abs(after) <= after[0])


def test_runge_kutta_keeps_order_four_with_demihulls_and_advance_loss() -> None:
    turning = commands(10, -10, (0.35,) * 4, 5)  # both demihulls stay between two towed speeds

    def end(substeps: int) -> float:
        gone = track(HEAVY, turning, velocity=(0.6, 0.05, 0.1), dt=0.8, substeps=substeps, azimuth_rate=1e3)
        assert gone[:, SURGE].min() - 0.4 * gone[:, YAW_RATE].max() > 0.5
        return float(gone[-1, NORTH])

    errors = [abs(end(substeps) - end(64)) for substeps in (1, 2, 4)]
    assert all(coarse > 10.0 * fine for coarse, fine in pairwise(errors))


@given(st.integers(1, 40), st.floats(-0.1, 4.2))
def test_a_speed_falls_into_the_piece_that_begins_at_the_last_knot_below_it(count: int, speed: float) -> None:
    knots = 0.1 * np.arange(count)
    for one in (speed, float(knots[-1]), float(knots[count // 2]), float(np.nextafter(knots[-1], 0.0))):
        piece, ahead = piece_of(one, np.tile(knots, (2, 1, 1)))
        assert piece == max(int(np.searchsorted(knots, one, side="right")) - 1, 0)
        assert ahead == max(one - knots[piece], 0.0)
