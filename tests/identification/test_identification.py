"""The papers' regressions: exact on their own models without noise, biased with it, clear on bad input."""

import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from swamp_rl.experiments.cli import app as cli

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.identification.deduction import deduction_points, paired, resistance_at, stretches
from swamp_rl.identification.elementary import bounded, expected, identify_surge, identify_yaw
from swamp_rl.identification.estimate import blocks_of, pseudo_inverse, with_intervals
from swamp_rl.identification.motion import motion_of, motions_of
from swamp_rl.identification.simulated import ahead_by_steps, on_the_spot, record_run, straights, zigzag
from swamp_rl.identification.yaw_model import (
    PUBLISHED,
    YawModel,
    by_pseudo_inverse,
    by_rollout,
    rollout,
)
from swamp_rl.runs import Run
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.sensors.observe import CHANNELS
from swamp_rl.simulator.state import HEADING, YAW_RATE
from tests.support.identification import NOISY, QUIET, folder_of, own_motion

pytestmark = pytest.mark.numerical

Array = NDArray[np.float64]

BOAT = load_boat("swamp-thesis")


def test_table_iii_implies_these_figures() -> None:
    assert PUBLISHED.steady_rate(math.radians(30), 0.8) == pytest.approx(0.2691, abs=1e-4)
    assert PUBLISHED.time_constant(0.8) == pytest.approx(0.982, abs=1e-3)
    assert PUBLISHED.unstable_above == pytest.approx(1.8645, abs=1e-4)
    assert PUBLISHED.steady_rate(0.5, 2.0) == math.inf


def test_the_rollout_settles_at_the_steady_rate_with_the_time_constant() -> None:
    dt, n = 0.01, 1000
    flat = np.ones((1, n))
    r = rollout(PUBLISHED, np.zeros(1), 0.8 * flat, 0.0 * flat, 0.5 * flat, dt)[0]
    steady, constant = PUBLISHED.steady_rate(0.5, 0.8), PUBLISHED.time_constant(0.8)
    assert r == pytest.approx(steady * (1 - np.exp(-np.arange(n) * dt / constant)), abs=1e-9)


def test_without_noise_the_pseudo_inverse_finds_the_model_and_so_does_the_rollout() -> None:
    motion = own_motion(0.0)
    found, estimates = by_pseudo_inverse(motion, PUBLISHED.inertia)
    assert found[:4] == pytest.approx(PUBLISHED[:4], rel=1e-9)
    for ends in ([one.low for one in estimates], [one.high for one in estimates]):  # no scatter, no width
        assert ends == pytest.approx(PUBLISHED[:4], rel=1e-9)
    rolled = by_rollout(motion, found)
    assert rolled[:4] == pytest.approx(PUBLISHED[:4], rel=1e-4)


def test_steering_that_lies_outside_of_all_rollouts_is_refused() -> None:
    motion = own_motion(0.0)
    row = np.arange(len(motion.time))
    late = motion._replace(steering=np.where(row < len(row) - 5, 0.0, 0.3)).rows(row >= 10)
    with pytest.raises(UserError, match=r"no steering: the angle is 0.0 deg in all \d+ stretches of 10 s"):
        by_rollout(late, PUBLISHED)


def test_a_guess_that_diverges_beyond_all_numbers_begins_a_search() -> None:
    found = by_rollout(own_motion(0.0), PUBLISHED._replace(k_r=1e6))
    assert np.isfinite(found).all()


def test_with_noise_the_pseudo_inverse_is_biased_and_the_rollout_is_not() -> None:
    """Noise on r is noise on its regressors: least squares shrinks the damping it finds."""
    damping = PUBLISHED.damping(0.8)
    regressed, rolled = [], []
    for seed in range(6):
        motion = own_motion(0.05, seed=seed)
        guess = by_pseudo_inverse(motion, PUBLISHED.inertia)[0]
        regressed.append(guess.damping(0.8))
        rolled.append(by_rollout(motion, guess).damping(0.8))
    assert np.mean(regressed) < 0.93 * damping
    assert np.mean(rolled) == pytest.approx(damping, rel=0.03)


def test_attenuation_is_what_theory_says() -> None:
    """y = b x with noise in x: the slope falls by var x / (var x + var noise)."""
    rng = np.random.default_rng(1)
    x = rng.standard_normal(200_000)
    seen = x + 0.5 * rng.standard_normal(x.size)
    assert pseudo_inverse(seen[:, None], 3.0 * x)[0] == pytest.approx(3.0 / 1.25, rel=0.01)


def test_the_intervals_cover_where_rows_are_not_independent() -> None:
    covered = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        noise = np.repeat(rng.standard_normal(40), 25)
        x = np.repeat(rng.standard_normal(40), 25)
        estimate = with_intervals(x[:, None], 2.0 * x + noise, blocks_of([1000], 25), pseudo_inverse, ["1"])[
            0
        ]
        covered += estimate.low <= 2.0 <= estimate.high
    assert covered >= 25


def test_bounds_are_kept() -> None:
    x = np.linspace(0, 1, 50)
    X = np.column_stack([x, x**2])
    assert bounded(X, -2 * x + x**2, np.array([5.0, 5.0]))[0] == pytest.approx(0.0, abs=1e-9)
    assert bounded(X, 9 * x, np.array([5.0, 50.0]))[0] == pytest.approx(5.0)


def test_turning_on_the_spot_gives_inertia_and_drag_of_the_closed_form() -> None:
    """At rest otherwise the hull's moment is exactly q C_D C_r^2 L^3 / 32 times r |r|."""
    q = 0.5 * BOAT.water_density * BOAT.length * BOAT.draught
    drag = q * float(BOAT.hull.c_d) * BOAT.hull.c_rn**2 * BOAT.length**3 / 32
    assert expected(BOAT)["yaw"] == pytest.approx((11.82, drag))
    run = record_run(BOAT, on_the_spot(BOAT, 0.05), 0.05, QUIET, np.random.default_rng(0))
    inertia, found = identify_yaw(motion_of(run, BOAT), BOAT)
    assert inertia.value == pytest.approx(11.82, rel=0.05)
    assert found.value == pytest.approx(drag, rel=0.02)


def test_noise_shrinks_the_mass_that_regression_finds() -> None:
    run = record_run(BOAT, ahead_by_steps(BOAT, 0.1), 0.1, NOISY, np.random.default_rng(0))
    clean = record_run(BOAT, ahead_by_steps(BOAT, 0.1), 0.1, QUIET, np.random.default_rng(0))
    assert identify_surge(motion_of(clean, BOAT), BOAT)[0].value == pytest.approx(60.9, rel=0.1)
    assert identify_surge(motion_of(run, BOAT), BOAT)[0].value < 15.0


def test_without_elementary_motion_it_says_what_to_record() -> None:
    run = record_run(BOAT, zigzag(BOAT, 0.1, 0.35), 0.1, QUIET, np.random.default_rng(0))
    with pytest.raises(UserError, match="record turns on the spot"):
        identify_yaw(motion_of(run, BOAT), BOAT)
    bare = Run("bare", {name: run.columns[name] for name in ("time", "north", "east", "heading")})
    with pytest.raises(UserError, match="column surge is missing"):
        motion_of(bare, BOAT)


def test_thrust_deduction_is_that_of_the_boat_file_ahead_and_astern() -> None:
    runs = [
        record_run(BOAT, straights(BOAT, 0.1, (0.4, 0.7, 1.0), ahead), 0.1, QUIET, np.random.default_rng(0))
        for ahead in (True, False)
    ]
    points = deduction_points(motions_of(runs, BOAT), BOAT)
    assert [point.ahead for point in points] == [True] * 3 + [False] * 3
    for point in points:
        truth = 0.30 + (point.throttle - 0.3) / 0.7 * 0.45
        assert point.factor == pytest.approx(truth, abs=0.006)
    assert resistance_at(BOAT, 0.99) == pytest.approx(9.68 * 1025 / 1001)


def test_a_current_shifts_one_direction_and_cancels_in_the_pair() -> None:
    from swamp_rl.effects import parse_effects

    given = parse_effects([{"effect": "current", "north": 0.1, "east": 0.0}], "test", BOAT.thruster_names)
    boat = BOAT.model_copy(update={"effects": tuple(given)})
    runs = [
        record_run(boat, straights(boat, 0.1, (0.7,), ahead), 0.1, QUIET, np.random.default_rng(0))
        for ahead in (True, False)
    ]
    points = deduction_points(motions_of(runs, BOAT), BOAT)
    truth = 0.30 + 0.4 / 0.7 * 0.45
    assert abs(points[0].factor - truth) > 0.1
    assert paired(points, BOAT)[0.7] == pytest.approx(truth, abs=0.01)


def test_the_interval_of_a_short_stretch_holds_the_true_deduction_in_95_of_100_cases() -> None:
    run = record_run(BOAT, straights(BOAT, 0.1, (0.7,), True), 0.1, QUIET, np.random.default_rng(0))
    (part,) = stretches(whole := motion_of(run, BOAT))
    chosen = np.zeros(len(whole.time), bool)
    chosen[part.start - 300 : part.start + 100] = True  # 10 s of it after it has settled
    short = whole.rows(chosen)
    (true,) = deduction_points(short, BOAT)
    rng, held = np.random.default_rng(1), 0
    for _ in range(400):
        noisy = short.velocity + [0.01, 0.0, 0.0] * rng.standard_normal((400, 3))
        (point,) = deduction_points(short._replace(velocity=noisy), BOAT)
        held += point.low <= true.factor <= point.high
    assert held / 400 == pytest.approx(0.95, abs=0.03)


def steered(throttle: float, held_angle: float | None) -> Run:
    """60 s steered by hand: on a course where no angle is held, for the boat does not keep it by itself."""
    rng, count = np.random.default_rng(0), 600
    params = parameters(BOAT)
    state = initial_state(params, np.array([[0.0, 0.0, 0.1]]))
    states, commands = np.zeros((count, 6)), np.zeros((count, 8))
    for i in range(count):
        states[i] = state[0, :6]
        angle = held_angle
        if angle is None:
            wanted = -state[0, HEADING] - 1.5 * state[0, YAW_RATE] + 0.02 * rng.standard_normal()
            angle = min(max(wanted, -0.2), 0.2)
        commands[i] = [angle, angle, -angle, -angle, *(4 * [throttle])]
        step(state, params, tank(BOAT), commands[i : i + 1], np.zeros(1, np.uint64), 0.1, 1)
    columns = {"time": 0.1 * np.arange(count)} | dict(zip(CHANNELS, states.T, strict=True))
    named = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in BOAT.thruster_names]
    return Run("steered", columns | dict(zip(named, commands.T, strict=True)))


def test_a_course_held_by_small_steering_is_a_straight_run_and_a_circle_is_none() -> None:
    points = deduction_points(motion_of(steered(0.7, None), BOAT), BOAT)
    assert [point.factor for point in points] == pytest.approx([0.30 + 0.4 / 0.7 * 0.45], abs=0.02)
    assert deduction_points(motion_of(steered(0.7, 0.1), BOAT), BOAT) == []


def test_the_steering_angle_is_the_bows() -> None:
    run = record_run(BOAT, zigzag(BOAT, 0.1, 0.35), 0.1, QUIET, np.random.default_rng(0))
    motion = motion_of(run, BOAT)
    assert np.abs(motion.steering).max() == pytest.approx(0.35, abs=1e-3)
    assert np.corrcoef(motion.steering, motion.jets[:, 2])[0, 1] > 0.999


def test_the_verbs_run_on_a_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(3)

    def recorded(name: str, *commands: Array) -> Path:
        runs = [record_run(BOAT, rows, 0.1, NOISY, rng, f"run{i}") for i, rows in enumerate(commands)]
        return folder_of(tmp_path / name, BOAT, runs)

    elementary = recorded("elementary", on_the_spot(BOAT, 0.1), straights(BOAT, 0.1, (0.5, 0.8), True))
    folders = {
        "yaw-model": recorded("zigzags", *(zigzag(BOAT, 0.1, 0.35, level) for level in (0.6, 0.9))),
        "elementary": elementary,
        "thrust-deduction": elementary,
    }
    entries = {}
    for verb, folder in folders.items():
        monkeypatch.setattr(sys, "argv", ["swamp-rl", "identify", verb, str(folder)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        assert stop.value.code == 0
        entries[verb] = capsys.readouterr().out
    assert all(f"{name} " in entries["yaw-model"] for name in ("k_r", "c_ru", "c_rv", "b_r"))
    assert "throttles from" in entries["yaw-model"]
    assert "boat file 11.82" in entries["elementary"]
    assert re.search(r"boat file \d+\.?\d* at \d\.\d\d m/s", entries["elementary"])
    assert entries["thrust-deduction"].count("95 %") == 2


def test_a_model_that_never_settles_says_so() -> None:
    assert YawModel(1.0, 0.0, 0.0, 1.0, 7.58).steady_rate(0.1, 0.5) == math.inf
    assert YawModel(-1.0, -1.0, 0.0, 1.0, 7.58).unstable_above == math.inf
