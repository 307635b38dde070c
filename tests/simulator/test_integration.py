"""The integration: order of convergence, the same bits in any batch, boats that differ within a batch."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.physics.noise import normal_pair, uniform
from swamp_rl.physics.thrusters import azimuth_after
from swamp_rl.simulator import initial_state, parameters, simulate, step, step_parallel, tank
from swamp_rl.simulator.state import ACTUATORS, GUST_SPEED, HEADING, NORTH, SURGE
from swamp_rl.simulator.step import _simulated
from swamp_rl.simulator.substeps import substeps_of
from tests.support.boats import commands, track
from tests.support.from_scratch import written

BOAT = load_boat("swamp")


def test_halving_the_step_cuts_the_error_as_order_four_should() -> None:
    command = commands(20, -10, (0.8, 0.7, 0.6, 0.5), 4)
    settled = track(BOAT, commands(20, -10, (0.8, 0.7, 0.6, 0.5), 200))[-1:]

    def end(substeps: int) -> np.ndarray:
        return track(BOAT, command, start=settled, dt=2.0, substeps=substeps, wind_speed=3.0)[-1, :6]

    exact = end(512)
    errors = [np.abs(end(substeps) - exact).max() for substeps in (8, 16, 32, 64)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 3.8) and np.all(orders < 4.4), (errors, orders)


def test_the_default_step_is_accurate_to_a_centimetre_over_half_a_minute_of_hard_steering() -> None:
    rng = np.random.default_rng(3)
    for _ in range(5):
        steering = np.repeat(rng.choice([-90.0, 0.0, 90.0], 60), 5)
        command = np.concatenate([commands(angle, 0, (1, 1, 0, 0), 1) for angle in steering])
        coarse, fine = (track(BOAT, command, substeps=n) for n in (substeps_of(0.1, BOAT), 40))
        assert np.hypot(*(coarse - fine)[:, :2].T).max() < 1e-2


@pytest.mark.parametrize("lag", [1e-6, 0.003, 0.01, 0.03, 0.1, 0.5])
def test_a_lag_of_the_pumps_acts_for_its_own_time_in_steps_that_are_longer(lag: float) -> None:
    throttles = np.repeat(np.random.default_rng(4).uniform(0.0, 1.0, (20, 4)), 10, axis=0)
    command = np.concatenate([np.zeros_like(throttles), throttles], axis=1)
    coarse, fine = (track(BOAT, command, substeps=n, pump_time_constant=lag) for n in (1, 400))
    without = track(BOAT, command, substeps=400)
    late = np.abs(fine - without)[:, SURGE].max()
    assert np.abs(coarse - fine)[:, SURGE].max() < 0.35 * late + 1e-6


def test_a_toy_of_a_third_of_a_metre_is_computed_to_a_thousandth_of_its_length(tmp_path: Path) -> None:
    toy = load_boat(written(tmp_path, "toy"))
    throttles = np.repeat(np.random.default_rng(0).uniform(0.0, 1.0, (20, 2)), 5, axis=0)
    command = np.concatenate([np.zeros_like(throttles), throttles], axis=1)
    coarse, fine = (track(toy, command, substeps=n) for n in (substeps_of(0.1, toy), 40))
    assert np.hypot(*(coarse - fine)[:, :2].T).max() < 1e-3 * toy.length


def varied_batch(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    params = parameters(BOAT, n)
    params["mass"] = rng.uniform(48, 60, n)
    params["current_north"] = rng.uniform(-0.3, 0.3, n)
    params["wind_speed"] = rng.uniform(0, 7, n)
    params["gust_speed_std"] = rng.uniform(0, 1, n)
    params["gust_direction_std"] = rng.uniform(0, 0.3, n)
    params["thruster_gain"] = rng.uniform(0.5, 1, (n, 4))
    params["depth_over_draught"] = rng.uniform(1.5, 10, n)
    start = initial_state(params, rng.uniform(-2, 2, (n, 3)))
    command = np.concatenate([rng.uniform(-1.5, 1.5, (n, 50, 4)), rng.uniform(0, 1, (n, 50, 4))], axis=2)
    return params, start, command, rng.integers(0, 2**63, n).astype(np.uint64)


def test_a_boat_moves_by_the_same_bits_alone_and_in_any_batch() -> None:
    params, start, command, seeds = varied_batch(130)
    together = simulate(params, tank(BOAT), start, command, seeds, 0.1, 2)
    for i in (0, 77, 129):
        one = slice(i, i + 1)
        alone = simulate(params[one], tank(BOAT), start[one], command[one], seeds[one], 0.1, 2)
        assert np.array_equal(alone[0], together[i])
    for advance in (step, step_parallel):
        state = start.copy()
        for j in range(command.shape[1]):
            advance(state, params, tank(BOAT), command[:, j].copy(), seeds, 0.1, 2)
        assert np.array_equal(state, together[:, -1])


def test_every_field_of_the_record_may_differ_from_boat_to_boat() -> None:
    params, start, command, seeds = varied_batch(2)
    base = parameters(BOAT, 2)
    start = initial_state(base, np.zeros((2, 3)))
    command = np.repeat(command[:1], 2, axis=0)
    for field, low, high in [("mass", 48, 60), ("wind_speed", 0, 5), ("depth_over_draught", 1.5, 9)]:
        params = base.copy()
        params[field] = [low, high]
        tracks = simulate(params, tank(BOAT), start, command, seeds, 0.1, 2)
        assert not np.allclose(tracks[0, -1, :3], tracks[1, -1, :3], atol=1e-4), field


def test_the_azimuth_motor_is_first_order_below_its_rate_limit() -> None:
    for time in (0.0, 0.02, 0.1, 0.5):
        assert azimuth_after(0.2, 0.5, 0.1, 8.587, time) == pytest.approx(0.5 - 0.3 * np.exp(-time / 0.1))


def test_the_azimuth_motor_never_turns_faster_than_its_rate_limit() -> None:
    times = np.linspace(0, 1, 400)
    angle = np.array([azimuth_after(-1.5, 1.5, 0.1, 4.0, t) for t in times])
    assert np.diff(angle).max() <= 4.0 * (times[1] - times[0]) * (1 + 1e-9)
    assert np.all(np.diff(angle) >= 0) and angle[-1] == pytest.approx(1.5, abs=0.02)
    # the same course whether taken in one piece or in two
    half = azimuth_after(-1.5, 1.5, 0.1, 4.0, 0.7)
    assert azimuth_after(half, 1.5, 0.1, 4.0, 0.2) == pytest.approx(azimuth_after(-1.5, 1.5, 0.1, 4.0, 0.9))


def test_a_thruster_that_is_fixed_stays_a_number() -> None:
    for time in (0.0, 0.05, 0.1):
        assert azimuth_after(0.3, 0.3, 0.0, np.inf, time) == 0.3
    assert azimuth_after(0.0, 1.0, 0.5, np.inf, 0.5) == pytest.approx(1.0 - np.exp(-1.0))


def test_an_azimuth_without_end_counts_its_turns_and_one_with_stops_halts_at_them() -> None:
    three_turns = commands(3 * 360.0, 0.0, (0.5, 0.5, 0.0, 0.0), 100)
    reached = track(BOAT, three_turns)[:, ACTUATORS]
    assert reached[-1] == pytest.approx(3 * 2 * np.pi, abs=1e-3)
    assert np.all(np.diff(reached) >= 0.0)
    stops = {"azimuth_min": -2 * np.pi, "azimuth_max": 2 * np.pi}
    assert track(BOAT, three_turns, **stops)[-1, ACTUATORS] == pytest.approx(2 * np.pi, abs=1e-3)


def test_a_slower_azimuth_turns_the_boat_later() -> None:
    command = commands(60, 0, (1, 1, 0, 0), 20)
    slow = track(BOAT, command, azimuth_time_constant=1.0)
    assert 0 < slow[-1, HEADING] < track(BOAT, command)[-1, HEADING]


def test_a_kick_of_a_stern_thruster_acts_only_in_its_window() -> None:
    command = commands(0, 0, (1, 1, 0, 0), 100)
    params = parameters(BOAT)
    kick = {
        name: np.where(np.arange(4) == 2, value, params[name][0])
        for name, value in {
            "kick_time": 4.0,
            "kick_duration": 2.0,
            "kick_throttle": 1.0,
            "kick_azimuth": 1.5,
        }.items()
    }
    calm, kicked = track(BOAT, command), track(BOAT, command, **kick)
    assert np.array_equal(calm[:41, :6], kicked[:41, :6])
    assert kicked[60, HEADING] < -0.05
    assert np.array_equal(kicked[70:, 9 + 4 + 2], np.zeros(31))


def test_gusts_have_the_stated_spread_and_memory() -> None:
    n = 400
    params = parameters(BOAT, n)
    params["wind_speed"], params["gust_speed_std"], params["gust_time_constant"] = 6.0, 1.2, 5.0
    start = initial_state(params, np.zeros((n, 3)))
    command = np.tile(commands(0, 0, (0,) * 4, 150), (n, 1, 1))
    seeds = np.random.default_rng(1).integers(0, 2**63, n).astype(np.uint64)
    gust = simulate(params, tank(BOAT), start, command, seeds, 0.1, 1)[:, 1:, GUST_SPEED]
    assert gust.std() == pytest.approx(1.2, rel=0.05)
    assert gust[:, 0].std() == pytest.approx(1.2, rel=0.1)
    correlation = np.mean(gust[:, :-50] * gust[:, 50:]) / np.mean(gust**2)
    assert correlation == pytest.approx(np.exp(-1.0), abs=0.07)


def test_the_counted_noise_is_uniform_and_normal() -> None:
    uniforms = np.array([uniform(np.uint64(7), i) for i in range(20_000)])
    normals = np.array([normal_pair(np.uint64(9), i) for i in range(10_000)])
    assert uniforms.mean() == pytest.approx(0.5, abs=0.01)
    assert uniforms.var() == pytest.approx(1 / 12, abs=0.003)
    assert np.abs(normals.mean(axis=0)).max() < 0.03 and normals.std(axis=0) == pytest.approx(1, abs=0.03)
    assert abs(np.corrcoef(normals.T)[0, 1]) < 0.03


def test_the_thesis_current_model_is_a_force_and_stands_alone() -> None:
    command = commands(0, 0, (0,) * 4, 200)
    pushed = track(BOAT, command, current_north=0.3, current_as_force=1.0)
    assert pushed[-1, SURGE] > 0.0 and pushed[-1, NORTH] > 0.0
    assert np.array_equal(track(BOAT, command, current_as_force=1.0), track(BOAT, command))


def test_boats_of_other_thrust_that_move_alike_are_simulated_together_as_alone() -> None:
    boats = parameters(BOAT, 2)
    boats["thrust_scale"] = [1.0, 0.5]
    given = np.tile(np.array([0.3, 0.3, -0.3, -0.3, 0.8, 0.8, 0.8, 0.8]), (2, 30, 1))
    start, seeds = initial_state(boats, np.zeros((2, 3))), np.zeros(2, np.uint64)
    together = simulate(boats, tank(BOAT), start, given, seeds, 0.1, 1)
    stepped = start.copy()
    for row in range(30):
        step(stepped, boats, tank(BOAT), given[:, row].copy(), seeds, 0.1, 1)
    np.testing.assert_array_equal(stepped, together[:, -1])
    for boat in range(2):
        own = slice(boat, boat + 1)
        alone = simulate(boats[own], tank(BOAT), start[own], given[own], seeds[own], 0.1, 1)
        np.testing.assert_array_equal(alone[0], together[boat])
    assert together[0, -1, SURGE] > 1.2 * together[1, -1, SURGE]


def test_commands_of_any_order_in_memory_need_no_other_machine_code() -> None:
    boat, seeds = BOAT, np.zeros(2, np.uint64)
    params = parameters(boat, 2)
    start = initial_state(params, np.zeros((2, 3)))
    asked = np.random.default_rng(0).uniform(0.0, 1.0, (2, 20, 8))
    first = simulate(params, tank(boat), start, asked, seeds, 0.1, 1)
    known = len(_simulated.signatures)
    for same in (np.asfortranarray(asked), np.repeat(asked, 2, axis=1)[:, ::2]):
        again = simulate(params, tank(boat), np.asfortranarray(start), same, seeds, 0.1, 1)
        np.testing.assert_array_equal(again, first)
    assert len(_simulated.signatures) == known
