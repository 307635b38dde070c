"""The reservoir pilot computes what reservoirpy does, and learns from runs."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots.demonstrations import choose_runs, observed
from swamp_rl.pilots.reservoir import (
    ReservoirSettings,
    fit_reservoir,
    states_along,
    untrained_reservoir,
)
from swamp_rl.runs import Run, RunMeta
from tests.support.patience import PATIENCE
from tests.support.runs import circling
from tests.support.steering_runs import RUNS, SMALL, steered, wandering

pytestmark = pytest.mark.numerical


def test_decisions_are_those_of_reservoirpy_to_1e_9() -> None:
    from reservoirpy.nodes import Reservoir, Ridge

    pilot = fit_reservoir(RUNS, SMALL)
    w = pilot.weights()
    reservoir = Reservoir(W=w["W"], Win=w["Win"], bias=w["bias"], lr=w["leak"])
    model = reservoir >> Ridge(Wout=w["Wout"], bias=w["out"])
    for run in (wandering(90), wandering(91)):
        reservoir.initialize(np.zeros((1, 4)))
        expected = model.run((observed(run, pilot.senses) - w["centre"]) / w["scale"])
        expected = np.clip(expected, [0.0, -1.0], [1.0, 1.0])
        np.testing.assert_allclose(steered(pilot, run), expected, rtol=0.0, atol=1e-9)


def test_no_folder_is_left_in_the_temporary_directory(tmp_path: Path) -> None:
    draw = "from swamp_rl.pilots.reservoir import np, untrained_reservoir as u; u(np.random.default_rng(0))"
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", draw], env=environment, check=True, timeout=PATIENCE)
    assert not list(tmp_path.iterdir())


def test_the_readout_is_the_ridge_solution_over_states_that_start_at_zero_in_each_run() -> None:
    pilot = fit_reservoir(RUNS, SMALL.model_copy(update={"matched": False}))
    states, levers = [], []
    for run in RUNS:
        pilot.reset(1)
        for row in observed(run, pilot.senses):
            pilot.act(row[None])
            states.append(pilot.state[0].copy())
        levers.append(run.joypad)
    x, y = np.array(states), np.concatenate(levers)
    x, y = x - x.mean(axis=0), y - y.mean(axis=0)
    wide = np.vstack([x, np.sqrt(SMALL.ridge) * np.eye(SMALL.units)])
    expected = np.linalg.lstsq(wide, np.vstack([y, np.zeros((SMALL.units, 2))]), rcond=None)[0]
    np.testing.assert_allclose(pilot.weights()["Wout"], expected, atol=1e-8)


def test_it_learns_a_steering_that_depends_on_the_past() -> None:
    late = [wandering(seed, lag=10) for seed in range(16)]
    pilot = fit_reservoir(late, SMALL.model_copy(update={"ridge": 1e-3}))
    for unseen in (wandering(seed, lag=10) for seed in (97, 98, 99)):
        error = steered(pilot, unseen)[:, 1] - unseen.joypad[:, 1]
        without_memory = 0.5 * np.sin(unseen.columns["heading"]) - unseen.joypad[:, 1]
        assert np.square(error[20:]).mean() < 0.2 * np.square(without_memory[20:]).mean()


def test_each_unit_hears_each_input_and_the_spectral_radius_is_as_asked() -> None:
    w = untrained_reservoir(np.random.default_rng(0)).weights()
    settings = ReservoirSettings()
    assert (w["Win"] != 0.0).all()
    assert np.abs(np.linalg.eigvals(w["W"])).max() == pytest.approx(settings.spectral_radius)
    assert np.abs(w["Win"][:, :2]).max() <= settings.position_scaling
    assert np.abs(w["Win"][:, 2:]).max() <= settings.input_scaling
    assert settings.leak[0] <= w["leak"].min() < w["leak"].max() <= settings.leak[1]


def test_boats_are_driven_independently_and_begin_anew_by_themselves() -> None:
    pilot = fit_reservoir(RUNS, SMALL)
    alone = steered(pilot, wandering(50))
    tracks = [observed(wandering(seed), pilot.senses) for seed in (51, 50, 52)]
    pilot.reset(3)
    together = []
    for t in range(200):
        together.append(pilot.act(np.array([track[t] for track in tracks])))
    np.testing.assert_allclose(np.array(together)[:, 1], alone, atol=1e-12)
    pilot.reset_boats(np.array([False, True, False]))
    assert (pilot.state[1] == 0.0).all() and (pilot.state[[0, 2]] != 0.0).any()
    again = np.array([pilot.act(np.array([track[t] for track in tracks]))[1] for t in range(50)])
    np.testing.assert_allclose(again, alone[:50], atol=1e-12)


def test_levers_stay_within_their_ways_far_from_all_that_was_learned() -> None:
    pilot = fit_reservoir(RUNS, SMALL)
    pilot.reset(500)
    levers = pilot.act(np.random.default_rng(0).normal(scale=1e6, size=(500, 4)))
    assert np.isfinite(levers).all()
    assert (levers >= [0.0, -1.0]).all() and (levers <= 1.0).all()


def test_nothing_is_learned_from_the_samples_of_the_washout() -> None:
    spoilt = [
        Run(run.name, run.columns | {"joy_angle": run.columns["joy_angle"].copy()}, run.meta) for run in RUNS
    ]
    for run in spoilt:
        run.columns["joy_angle"][:20] = -1.0
    late = SMALL.model_copy(update={"washout": 20})
    np.testing.assert_array_equal(*(fit_reservoir(runs, late).weights()["Wout"] for runs in (RUNS, spoilt)))


def test_the_same_seed_draws_the_same_pilot_and_another_one_another() -> None:
    noisy = SMALL.model_copy(update={"noise": 0.1})
    first, second = (fit_reservoir(RUNS, noisy).weights() for _ in range(2))
    other = fit_reservoir(RUNS, noisy.model_copy(update={"seed": 1})).weights()
    for name in first:
        np.testing.assert_array_equal(first[name], second[name])
    assert (first["W"] != other["W"]).any()


def test_a_run_without_a_joypad_cannot_be_learned_from() -> None:
    columns = {name: values for name, values in circling().items() if name != "joy_angle"}
    with pytest.raises(UserError, match="run afloat: column joy_angle is missing"):
        fit_reservoir([Run("afloat", columns)], SMALL)


def test_only_runs_of_the_outcome_asked_for_are_chosen() -> None:
    runs = [Run(str(i), circling(), RunMeta(outcome="buoy" if i % 3 == 0 else "success")) for i in range(9)]
    assert [run.name for run in choose_runs(runs, 3)] == ["1", "2", "4"]
    assert len(choose_runs(runs)) == 6
    assert [run.name for run in choose_runs(runs, outcomes=("buoy",))] == ["0", "3", "6"]
    with pytest.raises(UserError, match="7 runs with the outcome success asked for, 6 found"):
        choose_runs(runs, 7)
    with pytest.raises(UserError, match="none of 9 runs has the outcome timeout"):
        choose_runs(runs, outcomes=("timeout",))


def test_all_runs_in_one_batch_give_the_states_that_each_has_by_itself() -> None:
    runs = [wandering(seed, rows=rows) for seed, rows in enumerate((50, 200, 7, 120))]
    pilot = fit_reservoir(RUNS, SMALL)
    inputs = [
        (observed(run, pilot.senses) - pilot.weights()["centre"]) / pilot.weights()["scale"] for run in runs
    ]
    for run, states in zip(runs, states_along(pilot.weights(), inputs), strict=True):
        pilot.reset(1)
        for row, state in zip(observed(run, pilot.senses), states, strict=True):
            pilot.act(row[None])
            np.testing.assert_allclose(state, pilot.state[0], atol=1e-12)


def test_learned_row_by_row_it_is_the_pilot_that_is_learned_at_once() -> None:
    at_once, online = (
        fit_reservoir(RUNS, SMALL.model_copy(update={"forgetting": forgetting})).weights()
        for forgetting in (None, 1.0)
    )
    np.testing.assert_allclose(online["Wout"], at_once["Wout"], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(online["out"], at_once["out"], rtol=0.0, atol=1e-8)


def test_where_a_pilot_was_aboard_only_the_person_s_levers_are_learned() -> None:
    """The rows that the pilot drove still pass through the memory of those that learn."""
    runs = []
    for run in RUNS:
        by_person = np.arange(len(run.time)) % 60 < 30
        levers = {name: np.where(by_person, run.columns[name], 0.123) for name in ("joy_thrust", "joy_angle")}
        runs.append(Run(run.name, run.columns | levers | {"driver": np.where(by_person, 0.0, 1.0)}, run.meta))
    pilot, whole = fit_reservoir(runs, SMALL), fit_reservoir(RUNS, SMALL)
    unseen = wandering(97)
    error, of_whole = (np.square(steered(p, unseen) - unseen.joypad)[20:].mean() for p in (pilot, whole))
    assert error < 1.5 * of_whole


def test_runs_that_nobody_corrected_cannot_be_learned_from() -> None:
    alone = [Run(run.name, run.columns | {"driver": np.ones(200)}, run.meta) for run in RUNS]
    with pytest.raises(UserError, match="none of 8 runs has a row that a person drove"):
        fit_reservoir(alone, SMALL)
