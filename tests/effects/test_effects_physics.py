"""Each effect of the library against a closed form of its own, and the symmetries with effects at work."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.effects import LIBRARY
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.simulator import initial_state, simulate, step, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, NORTH, SURGE, SWAY, YAW_RATE
from tests.support.boats import Array, commands, forces_on_hull
from tests.support.effects import (
    BOAT,
    DT,
    EVERY_EFFECT,
    NO_RESISTANCE,
    STRONG,
    SURGE_MASS,
    SWAY_MASS,
    YAW_INERTIA,
    at_once,
    coast,
    lively,
    record,
    thrust_at,
    times,
    track,
)


@pytest.mark.parametrize(
    "name", [name for name, effect in LIBRARY.items() if effect.needs != "rudder" and not effect.battery]
)
def test_every_effect_of_the_library_changes_what_is_measured(name: str) -> None:
    beside = [{"effect": one} | STRONG[one] for one in (LIBRARY[name].beside,) if one]
    own = {"effect": name} | STRONG[name]
    without = observe(track(lively(), *beside)[None], record(), DT)
    with_effect = observe(track(lively(), *beside, own)[None], record(own), DT)
    assert np.abs(with_effect - without).max() > 0.02


def test_in_a_drifting_current_the_still_water_motion_is_carried_along() -> None:
    losses = [
        {"effect": "advance_thrust_loss", "factor": 0.8},
        {"effect": "crossflow_thrust_loss", "coefficient": 0.5},
    ]
    drift = {
        "effect": "drifting_current",
        "north": 0.1,
        "east": -0.2,
        "north_rate": 0.01,
        "east_rate": -0.003,
    }
    still = track(lively(), *losses)
    carried = track(lively(), *losses, drift, velocity=(0.1, -0.2, 0.0))
    t = times(still)
    assert carried[:, NORTH] == pytest.approx(still[:, NORTH] + 0.1 * t + 0.005 * t**2, abs=1e-9)
    assert carried[:, EAST] == pytest.approx(still[:, EAST] - 0.2 * t - 0.0015 * t**2, abs=1e-9)
    assert carried[:, HEADING] == pytest.approx(still[:, HEADING], abs=1e-9)
    cos, sin = np.cos(still[:, HEADING]), np.sin(still[:, HEADING])
    along = (0.1 + 0.01 * t) * cos + (-0.2 - 0.003 * t) * sin
    assert carried[:, SURGE] == pytest.approx(still[:, SURGE] + along, abs=1e-9)


def test_a_wave_swings_the_boat_away_from_where_it_comes() -> None:
    wave = {"effect": "waves", "force": 2.0, "frequency": 0.4, "from": 0.0, "phase": 0.3}
    swinging = track(coast(), wave, NO_RESISTANCE)
    omega = 2 * np.pi * 0.4
    closed = -2.0 / SURGE_MASS * (np.cos(0.3) - np.cos(omega * times(swinging) + 0.3)) / omega
    assert swinging[:, SURGE] == pytest.approx(closed, abs=1e-6)


def test_a_failed_thruster_pushes_until_it_fails_and_never_after() -> None:
    command = lively()
    off = command.copy()
    off[80:, 4] = 0.0  # bs
    failing = track(command, {"effect": "thruster_failure", "thruster": "bs", "time": 8.0})
    switched = track(off)
    assert failing[:, :6] == pytest.approx(switched[:, :6], abs=1e-9)


def test_the_track_is_continuous_in_the_time_of_failure() -> None:
    def end(time: float) -> Array:
        return track(lively(), {"effect": "thruster_failure", "thruster": "bs", "time": time})[-1, :6]

    moved = [np.abs(end(8.0 + later) - end(8.0)).max() for later in (1e-3, 1e-2)]
    assert 0 < moved[0] < 0.2 * moved[1] < 0.2


def test_an_azimuth_offset_turns_the_jet_as_a_commanded_angle_would() -> None:
    command, turned = lively(), lively()
    turned[:, 2] += 0.15
    params = record()
    start = initial_state(params, np.zeros((1, 3)))
    start[0, ACTUATORS + 2] = 0.15
    offset = track(command, {"effect": "azimuth_offset", "thruster": "ss", "offset": 0.15})
    assert offset[:, :6] == pytest.approx(track(turned, start=start)[:, :6], abs=1e-9)


def test_a_delay_of_whole_steps_shifts_the_commands() -> None:
    command = lively()
    late = np.concatenate([command[:1]] * 3 + [command[:-3]])
    delayed = track(command, {"effect": "command_delay", "delay": 3 * DT})
    assert delayed == pytest.approx(track(late), abs=1e-9)


def test_a_delay_of_half_a_step_mixes_the_two_commands_that_share_it() -> None:
    command = lively()
    before = np.concatenate([command[:1], command[:-1]])
    half = track(command, {"effect": "command_delay", "delay": 0.5 * DT})
    assert half == pytest.approx(track(0.5 * (command + before)), abs=1e-12)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 3.7])
def test_a_ring_of_past_commands_gives_what_the_whole_table_gives(delay: float) -> None:
    table, ring = lively(), np.zeros((6, 8))
    one, other = np.empty(8), np.empty(8)
    for tick in range(len(table)):
        ring[tick % len(ring)] = table[tick]
        delayed_command(table, tick, delay, one)
        delayed_command(ring, tick, delay, other)
        assert np.array_equal(one, other)


def test_a_slow_pump_follows_an_exponential() -> None:
    ahead = track(commands(0, 0, (0.8,) * 4, 50), {"effect": "pump_lag", "time_constant": 0.7})
    assert ahead[:, -1] == pytest.approx(0.8 * (1 - np.exp(-times(ahead) / 0.7)), abs=1e-12)


def test_swapped_channels_are_the_commands_exchanged() -> None:
    command = lively()
    swapped = track(command, {"effect": "channel_swap", "thruster": ["bs", "sp"]})
    assert np.array_equal(swapped, track(command[:, [3, 1, 2, 0, 7, 5, 6, 4]]))


def test_a_reversed_azimuth_is_the_command_of_the_other_sign() -> None:
    command = lively()
    turned = track(command, {"effect": "azimuth_reversed", "thruster": "sp"})
    assert np.array_equal(turned, track(command * [1, 1, 1, -1, 1, 1, 1, 1]))


def test_thrust_scale_and_sag_give_the_speed_of_their_impulse() -> None:
    worn = [{"effect": "thrust_scale", "scale": 0.8}, {"effect": "thrust_sag", "rate": 0.05}, NO_RESISTANCE]
    ahead = track(commands(0, 0, (0.5,) * 4, 300), *worn)
    t = np.minimum(times(ahead), 20.0)  # empty after 20 s
    assert ahead[:, SURGE] == pytest.approx(
        0.8 * thrust_at(0.5) / SURGE_MASS * (t - 0.5 * 0.05 * t**2), rel=1e-9
    )


def test_a_jet_that_loses_thrust_with_advance_nears_its_own_speed() -> None:
    ahead = track(
        commands(0, 0, (0.9,) * 4, 300), {"effect": "advance_thrust_loss", "factor": 0.7}, NO_RESISTANCE
    )
    thrust = thrust_at(0.9)
    jet_speed = np.sqrt(thrust / 4 / (1025 * 900e-6))
    rate = 0.7 * thrust / (SURGE_MASS * jet_speed)
    assert ahead[:, SURGE] == pytest.approx(jet_speed / 0.7 * (1 - np.exp(-rate * times(ahead))), abs=1e-8)


def test_crossflow_takes_its_exponential_of_a_jet_across_the_way() -> None:
    loss = {"effect": "crossflow_thrust_loss", "coefficient": 4.0}
    params = record(loss)
    start = initial_state(params, np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]]))
    start[0, ACTUATORS : ACTUATORS + 4] = np.pi / 2
    across = commands(90, 90, (0.7,) * 4, 1)
    end = simulate(params, tank(BOAT), start, across[None], np.zeros(1, np.uint64), 1e-4, 1)[0, -1]
    jet_speed_squared = thrust_at(0.7) / 4 / (1025 * 900e-6)
    expected = thrust_at(0.7) * np.exp(-4.0 / jet_speed_squared) / SWAY_MASS
    assert end[SWAY] / 1e-4 == pytest.approx(expected, rel=1e-3)


def test_runge_kutta_keeps_its_order_with_thrust_that_depends_on_speed() -> None:
    """Against the finest: halving the step divides the error by 16."""
    losses = [
        {"effect": "advance_thrust_loss", "factor": 1.0},
        {"effect": "crossflow_thrust_loss", "coefficient": 1.0},
    ]
    wave = {"effect": "waves", "force": 3.0, "frequency": 0.3, "from": 0.5}
    turning = commands(20, -20, (0.8,) * 4, 10)
    start = initial_state(record(), np.zeros((1, 3)), np.array([[0.4, 0.9, 0.0]]))
    start[0, ACTUATORS:] = turning[0]

    def end(substeps: int) -> Array:
        # sideways enough that the cross-flow keeps its sign along the hull, whose |w| w is not smooth at 0
        return track(turning, *losses, wave, NO_RESISTANCE, start=start, substeps=substeps)[-1, :6]

    finest = end(64)
    errors = [np.abs(end(n) - finest).max() for n in (1, 2, 4)]
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.4)
    assert errors[1] / errors[2] == pytest.approx(16, rel=0.4)


def test_resistance_scales_the_coasting() -> None:
    k = 1.6 * 1.38 / 0.49**2 * 1025 / 1001  # the tank's lowest point holds below it
    gliding = track(coast(), {"effect": "resistance", "scale": 1.6}, velocity=(0.4, 0, 0))
    assert gliding[:, SURGE] == pytest.approx(0.4 / (1 + k * 0.4 * times(gliding) / SURGE_MASS), rel=1e-6)


def test_a_linear_drag_slows_exponentially() -> None:
    gliding = track(
        coast(), {"effect": "linear_drag", "coefficient": 6.0}, NO_RESISTANCE, velocity=(0.8, 0, 0)
    )
    assert gliding[:, SURGE] == pytest.approx(0.8 * np.exp(-6.0 * times(gliding) / SURGE_MASS), rel=1e-6)


def test_sway_drag_scales_the_sideways_coasting() -> None:
    c_d = 1.5 * (-0.0591 * 1.24 / 0.14 + 1.848)
    k = 0.5 * 1025 * 1.24 * 0.14 * c_d
    drifting = track(
        coast(), {"effect": "sway_drag", "scale": 1.5}, NO_RESISTANCE, velocity=(0, 0.3, 0), substeps=8
    )
    assert drifting[:, SWAY] == pytest.approx(0.3 / (1 + k * 0.3 * times(drifting) / SWAY_MASS), rel=1e-5)


def test_a_payload_forward_turns_the_bow_against_a_push_amidships() -> None:
    x_g = 0.12
    _, sway, yaw = at_once(
        {"effect": "centre_of_gravity", "x_g": x_g}, {"effect": "external_force", "east": 5.0}
    )
    matrix = np.array([[SWAY_MASS, BOAT.mass * x_g], [BOAT.mass * x_g, YAW_INERTIA + BOAT.mass * x_g**2]])
    assert (sway, yaw) == pytest.approx(np.linalg.solve(matrix, [5.0, 0.0]), rel=1e-3)
    assert yaw < 0


def test_the_asymmetry_turns_by_its_moment_and_the_other_way_astern_and_inertia_divides_it() -> None:
    bias = {"effect": "hull_asymmetry", "yaw_moment": 2.0}
    heavy = {"effect": "yaw_inertia", "scale": 1.5}
    for surge, sign in ((0.8, 1.0), (-0.8, -1.0)):
        moment = sign * 2.0 * 0.64
        assert at_once(bias, velocity=(surge, 0, 0))[2] == pytest.approx(moment / YAW_INERTIA, rel=1e-3)
        inertia = 1.5 * BOAT.inertia_z - BOAT.added_inertia_yaw
        assert at_once(bias, heavy, velocity=(surge, 0, 0))[2] == pytest.approx(moment / inertia, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "axis", "unit"),
    [
        ("x_vr", 0, lambda u, v, r: v * r * 1.24),
        ("y_v", 1, lambda u, v, r: v * abs(u)),
        ("y_r", 1, lambda u, v, r: 1.24 * r * u),
        ("n_v", 2, lambda u, v, r: 1.24 * v * u),
        ("n_r", 2, lambda u, v, r: 1.24**2 * r * abs(u)),
    ],
)
def test_a_scaled_derivative_adds_its_own_term(name: str, axis: int, unit: Any) -> None:
    u, v, r = 0.8, -0.2, 0.3
    entry = {"effect": "hull_coefficients", name: 1.3}
    change = np.subtract(
        forces_on_hull(BOAT, record(entry)[0], u, v, r),
        forces_on_hull(BOAT, record()[0], u, v, r),
    )
    expected = np.zeros(3)
    expected[axis] = 0.3 * getattr(BOAT.hull, name) * 0.5 * 1025 * 1.24 * 0.14 * unit(u, v, r)
    assert change == pytest.approx(expected, abs=1e-9)
    if name == "n_r":
        assert record({"effect": "yaw_damping", "scale": 1.3}) == record(entry)


def test_mirrored_commands_give_the_mirrored_track_with_symmetric_effects() -> None:
    names = (
        "azimuth_lag command_delay pump_lag thrust_scale advance_thrust_loss crossflow_thrust_loss "
        "thrust_sag resistance linear_drag mass centre_of_gravity yaw_inertia sway_drag yaw_damping "
        "hull_coefficients linear_sway_damping linear_yaw_damping thruster_efficiency_curve"
    )
    entries = [{"effect": name} | STRONG[name] for name in names.split()]
    entries.append({"effect": "thruster_failure", "thruster": "all", "time": 15.03})
    entries.append({"effect": "throttle_dead_band", "thruster": "all", "below": 0.3})
    entries.append({"effect": "drag_asymmetry", "astern": 1.8})
    mirrored = lively()[:, [1, 0, 3, 2, 5, 4, 7, 6]]
    mirrored[:, :4] *= -1.0
    one, other = track(lively(), *entries), track(mirrored, *entries)
    other[:, [EAST, HEADING, SWAY, YAW_RATE]] *= -1.0
    assert one[:, :6] == pytest.approx(other[:, :6], abs=1e-9)


def test_a_boat_with_effects_gives_the_same_bits_alone_and_in_a_batch() -> None:
    batch = np.concatenate([record(), record(*EVERY_EFFECT), *(record(entry) for entry in EVERY_EFFECT)])
    n = len(batch)
    state = initial_state(batch, np.zeros((n, 3)))
    alone = [state[i : i + 1].copy() for i in range(n)]
    seeds = np.arange(n, dtype=np.uint64)
    for command in lively()[::5]:
        step(state, batch, tank(BOAT), np.tile(command, (n, 1)), seeds, DT, 2)
        for i in range(n):
            step(alone[i], batch[i : i + 1], tank(BOAT), command[None], seeds[i : i + 1], DT, 2)
    assert np.array_equal(state, np.concatenate(alone))
    assert np.all(np.isfinite(state))


def test_effects_at_their_neutral_values_change_no_bit_of_what_is_measured() -> None:
    named = [
        name for name, effect in LIBRARY.items() if all(p.neutral is not None for p in effect.parameters)
    ]
    neutral: list[dict[str, Any]] = []
    for name in named:
        effect = LIBRARY[name]
        entry: dict[str, Any] = {"effect": name} | {p.name: p.neutral for p in effect.parameters}
        if effect.parameters and name != "thruster_failure":
            neutral.append(entry | ({"thruster": "all"} if effect.thruster else {}))
    assert np.array_equal(record(*neutral), record())
    plain, same = track(lively()), track(lively(), *neutral)
    assert np.array_equal(plain, same)
    assert np.array_equal(observe(same[None], record(*neutral), DT)[0], plain[:, :6])


def test_thrust_is_as_the_reference_has_it() -> None:
    assert 4 * effective_thrust(0.5, 0, record()[0]) == pytest.approx(thrust_at(0.5), rel=1e-12)
