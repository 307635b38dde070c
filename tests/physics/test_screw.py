"""Thrusters with a propeller or a table: against the papers' formulae, their symmetry, continuity, energy."""

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import RegularGridInterpolator

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.propulsion import actuator_output, propulsion_forces
from swamp_rl.physics.screw import race_of, thrust_at
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.simulator import parameters
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, SURGE, SWAY, YAW_RATE
from tests.support import propellers as papers
from tests.support.boats import Array, track

D, MOST, WAKE, LOSS = 0.08, 25.0, 0.1, 0.5
TABLE = {
    "speed": [0.0, 1.0, 2.0],
    "rows": [
        {"throttle": -1.0, "thrust": [-20.0, -26.0, -34.0]},
        {"throttle": 0.5, "thrust": [8.0, 4.0, -2.0]},
        {"throttle": 1.0, "thrust": [30.0, 22.0, 12.0]},
    ],
}
COSINES, SINES = [0.01, 0.2, 0.0, -0.01], [0.0, -0.75, 0.02, 0.01]
MODELS: dict[str, dict[str, Any]] = {
    "disc": {"kind": "disc", "pitch_ratio": 1.0},
    "linear": {"kind": "linear", "bollard_coefficient": 0.45, "null_advance": 1.05},
    "four_quadrant": {"kind": "four_quadrant", "cosines": COSINES, "sines": SINES},
}
NO_CURVE = dict.fromkeys(
    ("thrust_linear", "thrust_quadratic", "astern_linear", "astern_quadratic", "advance_loss", "power"), None
)
throttles, speeds = st.floats(-1.0, 1.0), st.floats(-2.0, 3.0)


def screw(model: str, **others: Any) -> dict[str, Any]:
    """The section `propeller` of that model."""
    found = {"diameter": D, "revolutions_max": MOST, "revolutions_max_astern": MOST}
    return found | {"open_water": MODELS[model]} | others


@cache
def record_of(model: str) -> Array:
    """Parameters of a boat that examples share: `swamp_with` that model, or `mixed` with its table."""
    return parameters(mixed() if model == "table" else swamp_with(model))[0]


def swamp_with(model: str, **others: Any) -> Boat:
    """SWAMP with propellers in place of its jets."""
    keys: dict[str, Any] = {"propeller": screw(model, **others)}
    return load_boat("swamp", {"thruster_model": {**NO_CURVE, **keys}})


def mixed() -> Boat:
    """SWAMP's hull with a fixed stern propeller, measured as a table, and a bow jet that turns."""
    main = {"name": "main", "kind": "fixed", "x": -0.5, "y": 0.0, "azimuth_min": 0.0, "azimuth_max": 0.0}
    bow = {"name": "bow", "kind": "azimuth", "x": 0.5, "y": 0.0, "azimuth_rate": 3.0}
    bow |= {"azimuth_time_constant": 0.1, "pump_time_constant": 0.0, "thrust_quadratic": 6.0}
    main |= {"pump_time_constant": 0.1, "thrust_table": TABLE}
    keys = {"thruster_model": None, "thrusters": [main, bow], "joypad": {"thrusters": ["main", "bow"]}}
    return load_boat("swamp", {**keys, "battery": None})


def force(boat: Boat, command: Array, u: float, v: float, r: float) -> Array:
    """(3,) surge, sway force and yaw moment of all thrusters at settled commands (2K,)."""
    record, count = parameters(boat)[0], len(boat.thrusters)
    outputs = np.zeros((1, count, JET))
    for k in range(count):
        outputs[0, k, :2] = actuator_output(float(command[k]), float(command[count + k]), k, record)
    return np.array(propulsion_forces(outputs, 0, u, v, r, record))


def of_the_paper(model: str, throttle: float, speed: float, density: float) -> float:
    """Thrust of one propeller in the open by the papers' vectorised formulae."""
    n = throttle * MOST
    if model == "linear":
        return float(papers.linear_four_quadrant(density, D, n, speed, 0.45, 1.05))
    if model == "four_quadrant":
        series = papers.fourier_series(papers.advance_angle(n, speed, D), COSINES, SINES)
        return float(papers.four_quadrant_thrust(density, D, n, speed, series))
    if n == 0.0:
        return 0.0
    j = min(max(speed / (n * D), 0.0), 1.0)
    k_t = float(papers.disc_thrust_coefficient(j, 1.0))
    return math.copysign(k_t * density * n**2 * D**4, n)


@given(ratio=st.floats(0.3, 3.0), share=st.floats(0.0, 1.0))
def test_the_bladed_disc_of_the_paper_conserves_rothalpy(ratio: float, share: float) -> None:
    j, tangent = share * ratio, ratio / math.pi
    increase = float(papers.disc_speed_increase(j, ratio))
    # (14) with similar triangles at unit n d: w_1² = J² + π², w_2 axial speed J + Δ/2 along the blade
    leaving = (j + 0.5 * increase) ** 2 * (1.0 + 1.0 / tangent**2)
    entering = j**2 + math.pi**2
    assert entering - leaving == pytest.approx(
        2.0 * j * increase + increase**2 - (j + 0.5 * increase) ** 2 + j**2, abs=1e-6
    )


@pytest.mark.parametrize("model", list(MODELS))
def test_each_model_gives_the_papers_thrust_in_all_quadrants(model: str) -> None:
    record = record_of(model)
    for throttle in (-1.0, -0.3, 0.0, 0.4, 1.0):
        for speed in (-1.0, 0.0, 0.7, 2.5):
            ours = thrust_at(throttle, speed, 0, record)
            assert ours == pytest.approx(of_the_paper(model, throttle, speed, 1025.0), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("ratio", "known"), [(0.8, 0.399), (1.0, 0.559), (1.2, 0.714), (1.4, 0.858)])
def test_a_boat_file_with_a_disc_pulls_by_the_independent_programs_coefficient(
    ratio: float, known: float
) -> None:
    boat = swamp_with("disc", open_water={"kind": "disc", "pitch_ratio": ratio})
    linear, quadratic = boat.thrusters[0].thrust_curve(boat.water_density)
    assert (linear, quadratic) == (0.0, pytest.approx(known * 1025.0 * MOST**2 * D**4, rel=2e-3))
    assert thrust_at(1.0, 0.0, 0, parameters(boat)[0]) == pytest.approx(quadratic, rel=1e-12)


@settings(max_examples=40)
@given(st.sampled_from(["disc", "linear"]), throttles, speeds)
@example("disc", 0.0, 1.0)
def test_astern_a_propeller_is_its_own_mirror_image(model: str, throttle: float, speed: float) -> None:
    record = record_of(model)
    ahead, astern = thrust_at(throttle, speed, 0, record), thrust_at(-throttle, -speed, 0, record)
    assert astern == pytest.approx(-ahead, rel=1e-12, abs=1e-12)


@settings(max_examples=60)
@given(st.sampled_from([*MODELS, "table"]), throttles, speeds)
@example("disc", 0.0, 1.0)
@example("four_quadrant", 0.0, 0.0)
def test_thrust_is_continuous_in_throttle_and_speed(model: str, throttle: float, speed: float) -> None:
    record = record_of(model)
    here = thrust_at(throttle, speed, 0, record)
    for step in (1e-6, -1e-6):
        assert thrust_at(throttle + step, speed, 0, record) == pytest.approx(here, abs=1e-3)
        assert thrust_at(throttle, speed + step, 0, record) == pytest.approx(here, abs=1e-3)


@settings(max_examples=40)
@given(st.sampled_from(["disc", "linear"]), st.floats(0.05, 1.0), st.floats(0.0, 3.0))
def test_water_from_ahead_takes_thrust_and_none_is_left_at_the_null_advance(
    model: str, throttle: float, speed: float
) -> None:
    record = record_of(model)
    assert thrust_at(throttle, speed, 0, record) <= thrust_at(throttle, 0.0, 0, record) + 1e-12
    null = {"disc": 1.0, "linear": 1.05}[model] * throttle * MOST * D
    assert thrust_at(throttle, null, 0, record) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("model", ["disc", "linear"])
def test_the_race_keeps_more_energy_than_the_boat_gets(model: str) -> None:
    record = record_of(model)
    for speed in (0.2, 0.8, 1.4):
        thrust = thrust_at(1.0, speed, 0, record)
        race = race_of(thrust, speed, 0.25 * math.pi * D**2, record)
        ideal = 2.0 / (1.0 + math.sqrt(1.0 + 8.0 * thrust / (1025.0 * math.pi * D**2 * speed**2)))
        assert thrust * speed / (thrust * (speed + 0.5 * race)) == pytest.approx(ideal, rel=1e-9)


def test_a_table_is_bilinear_between_its_points_and_constant_beyond() -> None:
    record = record_of("table")
    rows = [row["thrust"] for row in TABLE["rows"]]  # type: ignore[index]
    grid = RegularGridInterpolator(
        ([-1.0, 0.0, 0.5, 1.0], [0.0, 1.0, 2.0]), np.array([rows[0], [0.0] * 3, *rows[1:]])
    )
    for throttle in (-1.0, -0.35, 0.0, 0.2, 0.5, 0.9, 1.0):
        for speed in (-1.0, 0.0, 0.4, 1.0, 1.7, 2.0, 5.0):
            known = float(grid((throttle, min(max(speed, 0.0), 2.0))))
            assert thrust_at(throttle, speed, 0, record) == pytest.approx(known, abs=1e-9)


def test_wake_and_cross_flow_act_as_the_papers_factor() -> None:
    boat = swamp_with("linear", wake=WAKE, crossflow_loss=LOSS)
    u, v = 0.8, 0.3
    ahead = force(boat, np.array([0.0] * 4 + [0.7] * 4), u, v, 0.0)
    thrust = of_the_paper("linear", 0.7, (1.0 - WAKE) * u, 1025.0)
    jet = math.sqrt(thrust / (1025.0 * 0.25 * math.pi * D**2))
    known = 4.0 * thrust * float(papers.crossflow_factor(v, jet, LOSS))
    assert ahead == pytest.approx([known, 0.0, 0.0], rel=1e-9, abs=1e-9)


def test_a_propeller_in_the_race_of_another_meets_faster_water() -> None:
    keys = {"kind": "fixed", "azimuth_min": 0.0, "azimuth_max": 0.0, "y": 0.0, "pump_time_constant": 0.0}
    two = [
        {"name": "front", "x": -0.3, **keys, "propeller": screw("linear")},
        {"name": "rear", "x": -0.5, **keys, "propeller": screw("linear", wash={"of": "front", "share": 0.6})},
    ]
    sides = {"name": "side", **keys, "x": 0.0, "y": 0.3, "propeller": screw("linear", side_share=0.1)}
    idle = {"name": "idle", **keys, "x": 0.0, "y": -0.3, "propeller": screw("linear")}
    given_keys = {"thruster_model": None, "thrusters": [*two, sides, idle], "joypad": {"thrusters": ["side"]}}
    boat = load_boat("swamp", {**given_keys, "battery": None})
    front = of_the_paper("linear", 1.0, 0.5, 1025.0)
    race = math.sqrt(0.25 + 2.0 * front / (1025.0 * 0.25 * math.pi * D**2)) - 0.5
    rear = of_the_paper("linear", 1.0, 0.5 + 0.6 * race, 1025.0)
    got = force(boat, np.array([0.0] * 4 + [1.0, 1.0, 0.0, 0.0]), 0.5, 0.0, 0.0)
    assert got == pytest.approx([front + rear, 0.0, 0.0], rel=1e-9, abs=1e-9)
    aside = force(boat, np.array([0.0] * 4 + [0.0, 0.0, 1.0, 0.0]), 0.5, 0.0, 0.0)
    assert aside == pytest.approx([front, 0.1 * front, -0.3 * front], rel=1e-9)


def test_mirrored_commands_give_the_mirrored_track_with_propellers_and_with_mixed_thrusters() -> None:
    rng = np.random.default_rng(3)
    angles, levels = rng.uniform(-1.5, 1.5, (12, 4)), rng.uniform(-1.0, 1.0, (12, 4))
    swap = [1, 0, 3, 2]
    command = np.repeat(np.hstack([angles, levels]), 10, axis=0)
    turned = np.repeat(np.hstack([-angles[:, swap], levels[:, swap]]), 10, axis=0)
    twin = swamp_with("linear", wake=WAKE, crossflow_loss=LOSS)
    one = np.repeat(np.stack([0.0 * angles[:, 0], angles[:, 1], levels[:, 0], levels[:, 1]], 1), 10, axis=0)
    other = one * np.array([1.0, -1.0, 1.0, 1.0])
    for boat, first, second in ((twin, command, turned), (mixed(), one, other)):
        a, b = track(boat, first), track(boat, second)
        b[:, [EAST, HEADING, SWAY, YAW_RATE]] *= -1.0
        assert np.allclose(a[:, :6], b[:, :6], rtol=0, atol=1e-9)


def test_stopped_propellers_never_drive_a_coasting_boat() -> None:
    coasting = track(swamp_with("four_quadrant"), np.zeros((100, 8)), velocity=(1.0, 0.0, 0.0))
    free = track(swamp_with("linear"), np.zeros((100, 8)), velocity=(1.0, 0.0, 0.0))
    assert np.all(np.diff(coasting[:, SURGE]) < 0.0)
    assert coasting[-1, SURGE] < free[-1, SURGE]  # a stopped four-quadrant propeller drags


def test_a_motor_takes_as_long_as_its_torque_and_inertia_say() -> None:
    motor = {"stall_torque": 0.9, "nominal_torque": 0.5, "nominal_speed": 300.0, "no_load_speed": 420.0}
    motor |= {"gear_ratio": 0.5, "inertia": 2e-3}
    boat = swamp_with("linear", torque_coefficient=0.05, motor=motor)

    def gain(_: float, speed: Any) -> Any:
        torque = float(papers.motor_torque(speed[0] / 0.5, 0.9, 0.5, 300.0, 420.0)) / 0.5
        return [(torque - 0.05 * 1025.0 * (speed[0] / (2.0 * math.pi)) ** 2 * D**5) / 2e-3]

    def there(_: float, speed: Any) -> float:
        return float(speed[0] - 0.9 * 2.0 * math.pi * MOST)

    there.terminal = True  # type: ignore[attr-defined]
    time = float(solve_ivp(gain, (0.0, 10.0), [0.0], events=there, rtol=1e-8).t[-1])
    rate = parameters(boat)["throttle_rate"][0, 0]
    assert rate == pytest.approx(0.9 / time, rel=1e-3)
    slow = load_boat(
        "swamp", {"thruster_model": {**NO_CURVE, "throttle_rate": 0.5, "propeller": screw("linear")}}
    )
    levels = track(slow, np.tile([0.0] * 4 + [1.0] * 4, (30, 1)))[:, ACTUATORS + 4]
    assert levels == pytest.approx(np.minimum(0.05 * np.arange(31), 1.0), abs=1e-9)


def test_a_ship_takes_the_same_models_behind_the_same_key() -> None:
    taken = {"k_t": None, "astern_thrust": None, "open_water": MODELS["linear"] | {"null_advance": 1.0}}
    ship = load_boat("esso_osaka", {"thrusters": {"main": {"propeller": taken}}})
    same = {"k_t": [0.45, -0.45, 0.0]}
    known = load_boat("esso_osaka", {"thrusters": {"main": {"propeller": same}}})
    command = np.tile([0.3, 12.0], (200, 1))
    assert track(ship, command)[:, :6] == pytest.approx(track(known, command)[:, :6], abs=1e-9)


def test_a_dead_band_of_a_ships_file_is_the_effects_dead_band() -> None:
    band = load_boat("esso_osaka", {"thrusters": {"main": {"dead_band": 0.25}}})
    most = band.thrusters[0].throttle_max
    plain = load_boat("esso_osaka")
    for share, known in ((0.2, 0.0), (0.7, 0.6), (1.0, 1.0)):
        command = np.array([0.2, share * most])
        assert force(band, command, 0.3, 0.0, 0.0) == pytest.approx(
            force(plain, np.array([0.2, known * most]), 0.3, 0.0, 0.0), rel=1e-12
        )


def test_at_rest_allocation_sees_what_the_simulator_gives() -> None:
    record = record_of("table")
    at_rest = force(mixed(), np.array([0.0, 0.0, 1.0, 0.0]), 0.0, 0.0, 0.0)
    assert at_rest[0] == pytest.approx(effective_thrust(1.0, 0, record), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"thrust_quadratic": 12.0}, "has propeller and a thrust curve; set"),
        ({"thrust_table": TABLE}, "has both propeller and thrust_table; give one"),
        ({"propeller": {"open_water": {"kind": "disk"}}}, "open_water"),
        ({"propeller": {"wake": 1.0}}, "wake: must be less than 1"),
        ({"propeller": {"diameter": 2.0}}, "diameter / length"),
        ({"propeller": {"wash": {"of": "bow", "share": 0.5}}}, "wash.of must name a thruster"),
    ],
)
def test_a_wrong_propeller_is_refused_with_its_key(
    change: dict[str, Any], message: str, tmp_path: Path
) -> None:
    first: dict[str, Any] = {**NO_CURVE, "propeller": screw("linear")}
    given_keys = {**first, **change, "propeller": {**first["propeller"], **change.get("propeller", {})}}
    with pytest.raises(Exception, match="swamp") as refused:
        load_boat("swamp", {"thruster_model": given_keys})
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speed": [0.5, 1.0, 2.0]}, "hold 0"),
        ({"rows": TABLE["rows"][:2]}, "to 1"),  # type: ignore[index]
        ({"rows": [{"throttle": 1.0, "thrust": [1.0]}]}, "a number for each speed"),
        (
            {"rows": [{"throttle": 0.5, "thrust": [5.0] * 3}, {"throttle": 1.0, "thrust": [4.0] * 3}]},
            "increase",
        ),
    ],
)
def test_a_wrong_table_is_refused_with_its_key(change: dict[str, Any], message: str) -> None:
    keys = {**NO_CURVE, "thrust_table": {**TABLE, **change}}
    with pytest.raises(Exception, match="thrust_table") as refused:
        load_boat("swamp", {"thruster_model": keys})
    assert message in str(refused.value)
