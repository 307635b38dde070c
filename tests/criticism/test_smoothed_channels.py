"""Channels that a filter smoothed before they were logged."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.nuisance.smoothed_channels import raised, smoothed_channels
from tests.support.criticism import DT, SIGMA, driven, gauss_markov_noise, simulated_runs

Array = np.ndarray
Filter = Callable[[Array], Array]
SECONDS = 0.3  # of the filters


def one_pole(values: Array) -> Array:
    """(R, T) after a filter of first order."""
    share = 1.0 - np.exp(-DT / SECONDS)
    found = values.copy()
    for row in range(1, values.shape[1]):
        found[:, row] += (1.0 - share) * (found[:, row - 1] - values[:, row])
    return found


def kalman(values: Array) -> Array:
    """(R, T) after a steady Kalman filter of a constant velocity (Kalata 1984), of gains for SECONDS."""
    index = (DT / SECONDS) ** 2
    root = (4.0 + index - np.sqrt(8.0 * index + index**2)) / 4.0
    alpha = 1.0 - root**2
    beta = 2.0 * (2.0 - alpha) - 4.0 * np.sqrt(1.0 - alpha)
    found, rate = values.copy(), np.zeros(len(values))
    for row in range(1, values.shape[1]):
        ahead = found[:, row - 1] + DT * rate
        missed = values[:, row] - ahead
        found[:, row], rate = ahead + alpha * missed, rate + beta / DT * missed
    return found


def filtered(runs: RunSet, way: Filter, *names: str) -> RunSet:
    """The runs with those channels after a filter."""
    measured = runs.measured.copy()
    for name in names:
        index = CHANNELS.index(name)
        measured[..., index] = way(measured[..., index])
    return replace(runs, measured=measured)


@pytest.mark.parametrize("way", [one_pole, kalman])
@pytest.mark.parametrize("seed", range(3))
def test_smoothed_channels_are_recognised_and_the_others_are_not(way: Filter, seed: int) -> None:
    runs = simulated_runs([{"effect": "thruster_gain", "thruster": "sp", "gain": 0.7}], seed)
    names = ("north", "east", "sway")
    found = smoothed_channels(filtered(runs, way, *names))
    assert set(found) == set(names)
    for name, one in found.items():
        true = SIGMA[CHANNELS.index(name)]
        assert one.sample_noise < 0.5 * true
        assert true < 1.3 * one.standard_deviation
    if way is one_pole:
        assert found["north"].time_constant_s == pytest.approx(SECONDS, rel=0.5)


@pytest.mark.parametrize("seed", range(40))
def test_white_noise_is_never_taken_for_a_filters(seed: int) -> None:
    effects = [[], [{"effect": "thruster_gain", "thruster": "sp", "gain": 0.7}]][seed % 2]
    runs = simulated_runs(effects, seed, velocities=seed % 4 < 2)
    assert smoothed_channels(runs) == {}
    sigmas = noise_levels(runs)
    np.testing.assert_array_equal(raised(sigmas, {}), sigmas)


def steered_every_second(seed: int) -> RunSet:
    """Three runs of 80 s with the bow thrusters turned to the side and back, once in a second or so."""
    rng = np.random.default_rng(seed)
    given = np.zeros((3, 800, 8))
    given[..., 4:6] = 0.6
    for run in given:
        turns = np.cumsum(rng.integers(8, 17, 120))
        angles = rng.choice([-1.5, 0.0, 1.5], len(turns) + 1)
        run[:, :2] = angles[np.searchsorted(turns, np.arange(len(run)), side="right"), None]
    return driven([], given, 0.8, seed)


@pytest.mark.parametrize("seed", range(5))
def test_the_motion_of_a_boat_that_is_steered_all_the_time_is_not_a_filters(seed: int) -> None:
    """Longer strides would be judged amid commands, shorter ones between them."""
    runs = steered_every_second(seed)
    assert smoothed_channels(runs) == {}
    assert set(smoothed_channels(filtered(runs, one_pole, "yaw_rate"))) == {"yaw_rate"}


@pytest.mark.parametrize("size", [0.5, 1.0, 2.0])
def test_a_quick_motion_beside_white_noise_is_no_filters_noise(size: float) -> None:
    """Forces with two integrals and a lag of 0.5 s, under noise that is seen at the highest frequencies."""
    runs, rng = simulated_runs([], 0), np.random.default_rng(1)
    force = rng.standard_normal(runs.measured.shape)
    for _ in range(3):
        force = lfilter([0.2], [1.0, -0.8], force, axis=1)
    poses = np.where(np.arange(6) < 3, size * force + 0.01 * rng.standard_normal(force.shape), np.nan)
    assert smoothed_channels(replace(runs, measured=poses)) == {}


def test_a_motion_that_fills_the_longer_strides_adds_nothing_to_the_noise() -> None:
    """A gyro's white noise and a receiver's wander, on a boat that turns and circles within seconds."""
    rng, dt = np.random.default_rng(2), 0.2
    measured = np.full((4, 800, 6), np.nan)
    time = dt * np.arange(800) + rng.uniform(0.0, 30.0, 4)[:, None]
    wander = gauss_markov_noise(rng, (4, 800), 0.3, 20.0 * DT / dt)
    measured[..., 0] = 8.0 * np.sin(time / 3.0) + wander + 0.02 * rng.standard_normal((4, 800))
    measured[..., 5] = 0.4 * np.sin(time / 1.5) + 0.0035 * rng.standard_normal((4, 800))
    still = np.zeros((4, 800, 8))
    runs = replace(simulated_runs([], 0), measured=measured, commands=still, dt=dt, lengths=np.full(4, 800))
    found = smoothed_channels(runs)
    assert "yaw_rate" not in found
    assert all(one.standard_deviation < 0.3 for one in found.values())


def test_a_wandering_receiver_a_slow_log_and_a_run_without_noise_are_not_filters() -> None:
    runs = simulated_runs([], 3)
    wander = gauss_markov_noise(np.random.default_rng(0), runs.measured[..., :2].shape, 0.3, 20.0)
    measured = runs.measured.copy()
    measured[..., :2] += wander
    assert smoothed_channels(replace(runs, measured=measured)) == {}
    every = filtered(runs, one_pole, *CHANNELS)
    slow = replace(
        every,
        dt=3 * DT,
        commands=every.commands[:, ::3],
        measured=every.measured[:, ::3],
        lengths=np.full(3, every.measured[:, ::3].shape[1]),
    )
    assert smoothed_channels(slow) == {}


@pytest.mark.parametrize("size", [0.3, 0.8, 2.0])
@pytest.mark.parametrize("seed", range(4))
def test_the_steps_of_a_wandering_position_are_not_a_filters(size: float, seed: int) -> None:
    runs = simulated_runs([], seed)
    measured = runs.measured.copy()
    wander = gauss_markov_noise(np.random.default_rng(seed), (*measured.shape[:2], 2), size, 20.0)
    measured[..., :2] += wander + 0.02 * np.random.default_rng(9).standard_normal(wander.shape)
    assert smoothed_channels(replace(runs, measured=measured)) == {}


@pytest.mark.parametrize("name", ["surge", "sway", "yaw_rate"])
@pytest.mark.parametrize("seed", range(3))
def test_a_velocity_that_wanders_under_white_noise_is_not_a_filters(name: str, seed: int) -> None:
    """As turbulence moves a boat, in ten runs, that good sensors measure."""
    rng, shape = np.random.default_rng(seed), (10, 800)
    measured = np.full((*shape, 6), np.nan)
    wander = gauss_markov_noise(rng, shape, 0.03, 10.0)
    measured[..., CHANNELS.index(name)] = wander + 0.003 * rng.standard_normal(shape)
    still = np.zeros((*shape, 8))
    runs = replace(simulated_runs([], 0), measured=measured, commands=still, lengths=np.full(10, 800))
    assert smoothed_channels(runs) == {}
    assert set(smoothed_channels(filtered(runs, one_pole, name))) == {name}


@pytest.mark.parametrize(("size", "names"), [(1e-12, set()), (1e-6, set(CHANNELS))])
def test_the_rounding_of_a_simulation_is_no_sensors_noise(size: float, names: set[str]) -> None:
    runs = simulated_runs([], 0)
    shape = runs.measured.shape
    steady = np.arange(shape[1])[:, None] * DT * np.full(6, 0.1)
    noise = gauss_markov_noise(np.random.default_rng(0), shape, size, SECONDS)
    assert set(smoothed_channels(replace(runs, measured=steady + noise))) == names


@pytest.mark.parametrize("size", [0.03, 0.1])
def test_a_motion_in_bursts_is_no_filters_noise(size: float) -> None:
    """As of a boat that turns for 2 s of every 6 and keeps its course for the others."""
    runs = simulated_runs([], 0)
    shape = runs.measured.shape
    seconds = np.arange(shape[1]) * DT
    turning = np.where(seconds % 6.0 < 2.0, 1.0 - np.cos(np.pi * seconds), 0.0)
    noise = 2e-4 * np.random.default_rng(0).standard_normal(shape)
    made = replace(runs, measured=size * turning[:, None] + 0.1 * seconds[:, None] + noise)
    assert smoothed_channels(made) == {}
    assert set(smoothed_channels(filtered(made, one_pole, "north"))) <= {"north"}


@pytest.mark.slow
@pytest.mark.parametrize("way", [one_pole, kalman])
def test_a_cause_is_found_and_measured_although_channels_were_smoothed(way: Filter) -> None:
    runs = simulated_runs([{"effect": "thruster_gain", "thruster": "sp", "gain": 0.7}], 1)
    runs = filtered(runs, way, "sway", "yaw_rate")
    found = examine(runs, None, np.random.default_rng(0)).diagnosis
    assert set(found.smoothed) == {"sway", "yaw_rate"}
    assert found.verdict == "cause"
    (cause,) = found.causes
    assert (cause.effect, cause.thruster) == ("thruster_gain", "sp")
    gain = cause.parameters["gain"]
    assert abs(gain.value - 0.7) < 4.0 * gain.standard_error < 0.04
    for name, one in found.smoothed.items():
        assert one.standard_deviation > 2.0 * one.sample_noise
        assert found.noise[name] == pytest.approx(one.standard_deviation, rel=1e-3)  # and the integration's
