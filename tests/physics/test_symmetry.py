"""Symmetry, invariance and energy: what a sign or a frame error would break."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.hull import crossflow_integrals
from swamp_rl.physics.motion import external_forces
from swamp_rl.simulator import parameters
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, YAW_RATE
from tests.support.boats import Array, commands, forces_on_hull, track, with_foils

BOAT = load_boat("swamp")
FOILED = with_foils(stall_angle=0.4, gamma=0.7)
LENGTH = BOAT.length
speeds = st.floats(-1.5, 1.5)


def lively_commands(seed: int, steps: int = 300) -> Array:
    """Random azimuths and throttles of all four thrusters, changed once a second."""
    rng = np.random.default_rng(seed)
    chosen = np.concatenate(
        [rng.uniform(-np.pi / 2, np.pi / 2, (steps // 10, 4)), rng.uniform(0, 1, (steps // 10, 4))], axis=1
    )
    return np.repeat(chosen, 10, axis=0)


def mirrored_commands(command: Array) -> Array:
    """Port for starboard: bs with bp, ss with sp, azimuths negated."""
    swap = [1, 0, 3, 2]
    return np.concatenate([-command[:, :4][:, swap], command[:, 4:][:, swap]], axis=1)


@pytest.mark.parametrize("boat", [BOAT, FOILED], ids=["jets", "with foils"])
@pytest.mark.parametrize("seed", range(3))
def test_mirrored_commands_give_the_mirrored_track(seed: int, boat: Boat) -> None:
    command = lively_commands(seed)
    weather = {"current_north": 0.1, "wind_speed": 4.0, "wind_from": 0.0, "external_force_north": 0.7}
    one = track(boat, command, **weather)
    other = track(boat, mirrored_commands(command), **weather)
    other[:, [EAST, HEADING, SWAY, YAW_RATE]] *= -1.0
    assert np.allclose(one[:, :6], other[:, :6], rtol=0, atol=1e-9)


@pytest.mark.parametrize("boat", [BOAT, FOILED], ids=["jets", "with foils"])
@pytest.mark.parametrize("seed", range(3))
def test_motion_in_a_uniform_current_is_the_still_water_motion_carried_along(seed: int, boat: Boat) -> None:
    command, north, east = lively_commands(seed), 0.31, -0.22
    still = track(boat, command)
    # at rest relative to the moving water at the start, as the other is in still water
    drifting = track(boat, command, velocity=(north, east, 0.0), current_north=north, current_east=east)
    time = 0.1 * np.arange(len(command) + 1)
    assert np.allclose(drifting[:, NORTH] - north * time, still[:, NORTH], rtol=0, atol=1e-9)
    assert np.allclose(drifting[:, EAST] - east * time, still[:, EAST], rtol=0, atol=1e-9)
    assert np.allclose(drifting[:, HEADING], still[:, HEADING], rtol=0, atol=1e-9)


def test_turning_the_earth_turns_the_track() -> None:
    command, angle = lively_commands(5), 0.7
    one = track(BOAT, command, wind_speed=5.0, wind_from=0.4, current_north=0.2)
    other = track(
        BOAT,
        command,
        pose=(0.0, 0.0, angle),
        wind_speed=5.0,
        wind_from=0.4 + angle,
        current_north=0.2 * np.cos(angle),
        current_east=0.2 * np.sin(angle),
    )
    cos, sin = np.cos(angle), np.sin(angle)
    turned = np.stack([one[:, NORTH] * cos - one[:, EAST] * sin, one[:, NORTH] * sin + one[:, EAST] * cos])
    assert np.allclose(turned, other[:, [NORTH, EAST]].T, rtol=0, atol=1e-9)


def test_with_thrusters_off_the_boat_ends_up_moving_with_the_current() -> None:
    drift = track(
        BOAT, commands(0, 0, (0,) * 4, 30_000), pose=(0, 0, 0.5), current_north=0.2, current_east=-0.1
    )
    cos, sin = np.cos(drift[:, HEADING]), np.sin(drift[:, HEADING])
    north = drift[:, SURGE] * cos - drift[:, SWAY] * sin
    east = drift[:, SURGE] * sin + drift[:, SWAY] * cos
    slip = np.hypot(north - 0.2, east + 0.1)
    # against a square law m s' = -k s^2 the slip can fall no slower than m / (k t); lengthways k is least
    least_drag = 1.38 / 0.49**2 * 1025 / 1001
    assert slip[-1] < (BOAT.mass - BOAT.added_mass_surge) / (least_drag * 3000.0)
    assert np.all(np.diff(slip) <= 1e-12)
    assert (north[-1], east[-1]) == pytest.approx((0.2, -0.1), abs=4e-3)


@settings(max_examples=40, deadline=None)
@given(u=speeds, v=speeds, r=st.floats(-1.5, 1.5))
def test_kinetic_energy_never_rises_in_still_water_without_thrust(u: float, v: float, r: float) -> None:
    p = parameters(BOAT)[0]
    coasting = track(BOAT, commands(0, 0, (0,) * 4, 200), velocity=(u, v, r))
    energy = 0.5 * (
        (p["mass"] - p["added_mass_surge"]) * coasting[:, SURGE] ** 2
        + (p["mass"] - p["added_mass_sway"]) * coasting[:, SWAY] ** 2
        + (p["inertia_z"] - p["added_inertia_yaw"]) * coasting[:, YAW_RATE] ** 2
    )
    assert np.all(np.diff(energy) <= 1e-12)


def test_wind_from_starboard_pushes_to_port() -> None:
    drift = track(BOAT, commands(0, 0, (0,) * 4, 50), wind_speed=5.0, wind_from=np.pi / 2)
    assert drift[-1, SWAY] < -0.01
    assert drift[-1, EAST] < -0.01


def test_a_head_wind_slows_the_boat() -> None:
    ahead = commands(0, 0, (1, 1, 0, 0), 300)
    assert track(BOAT, ahead, wind_speed=5.0, wind_from=0.0)[-1, SURGE] < track(BOAT, ahead)[-1, SURGE]


@pytest.mark.parametrize("current", [0.0, 0.3])
def test_a_wind_that_dies_away_leaves_the_track_of_calm_air(current: float) -> None:
    command = lively_commands(2)
    calm = track(BOAT, command, current_north=current)
    apart = [
        np.abs(track(BOAT, command, current_north=current, wind_speed=speed, wind_from=1.1) - calm).max()
        for speed in (1e-4, 1e-6)
    ]
    assert 0.0 < apart[1] < 0.02 * apart[0] < 1e-4


def test_the_tank_measured_the_boats_own_air_drag_so_a_wind_adds_what_calm_air_lacks() -> None:
    p = parameters(load_boat("swamp"))[0]
    own, wind = 1.2, 5.0  # m/s: a head wind on a boat that goes ahead

    def drag(speed: float) -> float:
        return float(0.5 * p["air_density"] * p["air_frontal_area"] * p["air_c_x"] * speed**2)

    surge, sway, yaw = external_forces(1.0, 0.0, own, 0.0, 0.0, (wind, 0.0), p)
    assert surge == pytest.approx(drag(own) - drag(own + wind))
    assert sway == yaw == 0.0


def test_a_thruster_to_starboard_pushing_ahead_turns_the_bow_to_port() -> None:
    for throttle in [(0.8, 0, 0, 0), (0, 0, 0.8, 0)]:  # bs and ss stand to starboard
        turn = track(BOAT, commands(0, 0, throttle, 30))
        assert turn[-1, YAW_RATE] < -0.01
        assert turn[-1, HEADING] < -0.01


def test_bow_thrusters_at_positive_azimuth_turn_the_bow_to_starboard() -> None:
    turn = track(BOAT, commands(60, 0, (0.8, 0.8, 0, 0), 30))
    assert turn[-1, YAW_RATE] > 0.01


def test_a_steady_push_to_the_east_moves_the_boat_east_whatever_its_heading() -> None:
    for heading in np.linspace(-3, 3, 7):
        pushed = track(BOAT, commands(0, 0, (0,) * 4, 30), pose=(0, 0, heading), external_force_east=3.0)
        assert pushed[-1, EAST] > 0.05


@given(
    u=st.sampled_from([0.0, 1e-300, -1e-9, 0.5, -1.6, 2.5]),
    v=st.sampled_from([0.0, -1e-300, 1e-9, -0.7, 1.1]),
    r=st.sampled_from([0.0, 1e-300, -1e-12, 2.0, -0.5]),
)
def test_hull_forces_are_finite_everywhere(u: float, v: float, r: float) -> None:
    assert np.all(np.isfinite(forces_on_hull(BOAT, parameters(BOAT)[0], u, v, r)))


def test_the_track_is_finite_through_zero_speed_and_hard_astern() -> None:
    astern = np.concatenate(
        [commands(0, 0, (1,) * 4, 100), commands(180, 180, (1,) * 4, 300), commands(90, -90, (1,) * 4, 100)]
    )
    there_and_back = track(BOAT, astern)
    assert np.all(np.isfinite(there_and_back))
    assert there_and_back[:, SURGE].max() > 1.0 > -1.0 > there_and_back[:, SURGE].min()


@given(a=st.floats(-2, 2), b=st.floats(-3, 3))
@settings(max_examples=60, deadline=None)
def test_the_closed_form_of_the_cross_flow_equals_quadrature(a: float, b: float) -> None:
    root = [-a / b] if abs(b) > 1e-9 and abs(a / b) < LENGTH / 2 else None

    def integral(power: int) -> float:
        def density(x: float) -> float:
            return abs(a + b * x) * (a + b * x) * x**power

        return quad(density, -LENGTH / 2, LENGTH / 2, points=root)[0]

    force, moment = crossflow_integrals(a, b, LENGTH)
    assert force == pytest.approx(integral(0), abs=1e-9)
    assert moment == pytest.approx(integral(1), abs=1e-9)


@given(a=st.floats(-1, 1), b=st.sampled_from([1e-12, 1e-6, 1e-3]))
def test_the_cross_flow_is_smooth_through_zero_yaw_rate(a: float, b: float) -> None:
    at_zero = crossflow_integrals(a, 0.0, LENGTH)
    assert at_zero[0] == pytest.approx(abs(a) * a * LENGTH, abs=1e-12)
    assert crossflow_integrals(a, b, LENGTH)[0] == pytest.approx(at_zero[0], abs=3 * b * (abs(a) + b))
