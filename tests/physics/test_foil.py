"""Foils of thrusters: their force and energy, and the order of the integration."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.physics.foil import foil_forces
from swamp_rl.physics.rudder import rudder_forces
from swamp_rl.simulator import parameters
from swamp_rl.simulator.state import SURGE, SWAY, YAW_RATE
from tests.support.boats import FOIL, Array, commands, track, with_foils

AREA, ASPECT = FOIL["area"], FOIL["aspect_ratio"]
SLOPE = 6.13 * ASPECT / (2.25 + ASPECT)
speeds, rates = st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)
angles = st.floats(-math.pi, math.pi)


BOAT = with_foils()
RECORD = parameters(BOAT)[0]


def bs_of(u: float, v: float, r: float) -> Array:
    """Velocity (2,) of the thruster bs through the water."""
    return np.array([u - r * float(RECORD["thruster_y"][0]), v + r * float(RECORD["thruster_x"][0])])


@given(angle=angles, u=speeds, v=speeds, r=rates)
def test_the_force_is_that_of_a_flat_foil_in_the_flow_at_the_thruster(
    angle: float, u: float, v: float, r: float
) -> None:
    flow, chord = bs_of(u, v, r), np.array([math.cos(angle), math.sin(angle)])
    speed = math.hypot(*flow)
    attack = math.atan2(chord[0] * flow[1] - chord[1] * flow[0], chord @ flow)
    normal = 0.5 * BOAT.water_density * AREA * SLOPE * speed**2 * math.sin(attack)
    force = -normal * np.array([-chord[1], chord[0]])
    x, y, n = foil_forces(angle, u, v, r, 0, RECORD)
    assert (x, y) == pytest.approx(tuple(force), abs=1e-9)
    at = BOAT.thrusters[0]
    assert n == pytest.approx(at.x * y - at.y * x, abs=1e-12)


def test_lift_is_across_the_flow_and_the_induced_drag_along_it() -> None:
    attack, speed = 0.2, 1.2
    x, y, _ = foil_forces(attack, speed, 0.0, 0.0, 0, RECORD)
    pressure = 0.5 * BOAT.water_density * speed**2 * AREA * SLOPE
    assert y == pytest.approx(pressure * math.sin(attack) * math.cos(attack))
    assert -x == pytest.approx(pressure * math.sin(attack) ** 2)


def test_a_rudder_outside_of_the_race_has_the_same_force() -> None:
    rudder = parameters(load_boat("esso_osaka"))
    rudder["rudder_area"], rudder["rudder_aspect_ratio"] = AREA, ASPECT
    rudder["rudder_deduction"], rudder["rudder_a_h"] = 0.0, 0.0
    rudder["water_density"] = BOAT.water_density
    # u_R, v_R are the water's velocity past the rudder, whose angle is positive to port
    surge, sway, _ = rudder_forces(-0.3, 1.1, -0.2, 0, rudder[0])
    own = foil_forces(0.3, 1.1, 0.2, 0.0, 0, RECORD)
    assert (surge, sway) == pytest.approx(own[:2])


@given(angle=angles, u=speeds, v=speeds, r=rates)
def test_a_foil_takes_energy_from_every_motion_through_the_water(
    angle: float, u: float, v: float, r: float
) -> None:
    for boat in (BOAT, with_foils(stall_angle=0.3)):
        x, y, n = foil_forces(angle, u, v, r, 0, parameters(boat)[0])
        assert x * u + y * v + n * r <= 1e-12


@settings(max_examples=20, deadline=None)
@given(u=speeds, v=speeds, r=rates, bow=st.floats(-90, 90), stern=st.floats(-90, 90))
def test_kinetic_energy_never_rises_with_stopped_thrusters(
    u: float, v: float, r: float, bow: float, stern: float
) -> None:
    coasting = track(BOAT, commands(bow, stern, (0,) * 4, 200), velocity=(u, v, r))
    energy = 0.5 * (
        (RECORD["mass"] - RECORD["added_mass_surge"]) * coasting[:, SURGE] ** 2
        + (RECORD["mass"] - RECORD["added_mass_sway"]) * coasting[:, SWAY] ** 2
        + (RECORD["inertia_z"] - RECORD["added_inertia_yaw"]) * coasting[:, YAW_RATE] ** 2
    )
    assert np.all(np.diff(energy) <= 1e-12)


def test_a_stopped_thruster_still_steers_by_its_foil() -> None:
    turned = commands(30, 0, (0,) * 4, 30)
    with_foil = track(BOAT, turned, velocity=(1.2, 0.0, 0.0))[-1, YAW_RATE]
    without = track(load_boat("swamp"), turned, velocity=(1.2, 0.0, 0.0))[-1, YAW_RATE]
    assert with_foil > 0.02
    assert without == 0.0


def test_a_foil_turns_the_boat_the_way_that_the_thrust_does() -> None:
    turned = commands(20, -20, (0.5,) * 4, 30)
    assert track(BOAT, turned)[-1, YAW_RATE] > track(load_boat("swamp"), turned)[-1, YAW_RATE] > 0.0


def test_beyond_the_stall_angle_the_force_across_the_chord_does_not_rise() -> None:
    stalls = parameters(with_foils(stall_angle=0.35))[0]

    def normal(angle: float, record: Any) -> float:
        x, y, _ = foil_forces(angle, 1.0, 0.0, 0.0, 0, record)
        return y * math.cos(angle) - x * math.sin(angle)

    assert normal(0.34, stalls) == pytest.approx(normal(0.34, RECORD))
    assert normal(0.8, stalls) == pytest.approx(normal(0.35, RECORD))
    assert normal(-1.2, stalls) == pytest.approx(-normal(0.35, RECORD))


def test_gamma_straightens_the_flow_across_the_boat() -> None:
    half = parameters(with_foils(gamma=0.5))[0]
    at = BOAT.thrusters[0]
    for angle in (0.0, 0.4):
        straightened = foil_forces(angle, 1.0, 0.2, 0.1, 0, half)
        u, v = bs_of(1.0, 0.2, 0.1)
        expected = foil_forces(angle, u, 0.5 * v, 0.0, 0, RECORD)
        assert straightened[:2] == pytest.approx(expected[:2])
        assert straightened[2] == pytest.approx(at.x * expected[1] - at.y * expected[0])


def test_the_integration_is_of_order_four() -> None:
    held = commands(40, -10, (0.6,) * 4, 50)
    start = track(BOAT, held, velocity=(1.0, 0.1, 0.1))[-1:]  # the motors are at rest from here on

    def end(substeps: int) -> Array:
        return track(BOAT, held[:4], start=start, dt=1.0, substeps=substeps)[-1, :6]

    finest = end(64)
    coarse, fine = (float(np.abs(end(n) - finest).max()) for n in (2, 4))
    assert 12.0 < coarse / fine < 20.0


def test_a_foil_stays_when_its_thruster_fails() -> None:
    turned = commands(30, 0, (0.5, 0.5, 0, 0), 40)
    failed = track(BOAT, turned, velocity=(1.2, 0.0, 0.0), failure_time=0.0)
    stopped = track(BOAT, commands(30, 0, (0,) * 4, 40), velocity=(1.2, 0.0, 0.0))
    assert failed[-1, YAW_RATE] == pytest.approx(stopped[-1, YAW_RATE], rel=1e-9)


def test_the_foil_of_one_thruster_leaves_the_others_as_they_are() -> None:
    """A boat with a propeller, a jet with a foil and one without."""
    screw = {"diameter": 0.08, "revolutions_max": 25.0}
    screw["open_water"] = {"kind": "linear", "bollard_coefficient": 0.45, "null_advance": 1.05}  # type: ignore[assignment]
    main: dict[str, Any] = {"name": "main", "kind": "fixed", "x": -0.5, "y": 0.0}
    main |= {"azimuth_min": 0.0, "azimuth_max": 0.0, "pump_time_constant": 0.1, "propeller": screw}
    bow: dict[str, Any] = {"name": "bow", "kind": "azimuth", "x": 0.5, "y": 0.0, "azimuth_rate": 3.0}
    bow |= {"azimuth_time_constant": 0.1, "pump_time_constant": 0.0, "thrust_quadratic": 6.0}
    keys: dict[str, Any] = {"thruster_model": None, "battery": None, "joypad": {"thrusters": ["main", "bow"]}}
    plain = load_boat("swamp", {**keys, "thrusters": [main, bow]})
    foiled = load_boat("swamp", {**keys, "thrusters": [main, bow | {"foil": FOIL}]})
    turned = np.tile([0.0, 0.5, 0.6, 0.0], (30, 1))
    ahead = np.tile([0.0, 0.0, 0.6, 0.0], (30, 1))
    assert track(plain, turned, velocity=(1.0, 0.0, 0.0))[-1, YAW_RATE] == 0.0
    assert track(foiled, turned, velocity=(1.0, 0.0, 0.0))[-1, YAW_RATE] > 0.005
    same = track(plain, ahead, velocity=(1.0, 0.0, 0.0)), track(foiled, ahead, velocity=(1.0, 0.0, 0.0))
    assert np.allclose(*same, rtol=0, atol=1e-12)
