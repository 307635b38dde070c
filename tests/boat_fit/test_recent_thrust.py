"""Predictions with thruster gains from the recent past of the same run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit.fit import soft_weights
from swamp_rl.boat_fit.recent_thrust import (
    STRETCH,
    chosen_gains,
    predictor,
    recent_errors,
    recent_gains,
    thruster_gains,
)
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import Gap, RunSet, read_run_set
from swamp_rl.criticism.likelihood.prediction_error import restarts, trivial_predictors
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

WEED = "extends: twin.yaml\nname: weed\neffects: [{effect: thruster_gain, thruster: port, gain: 0.4}]\n"


def weedy(folder: Path, seconds: float) -> RunSet:
    """A run in which port gives 0.4 of its thrust, read as one of the boat without weed."""
    written(folder, "twin")
    (folder / "weed.yaml").write_text(WEED)
    truth, start = load_boat(folder / "weed.yaml"), folder / "twin.yaml"
    sailed_dataset(folder / "runs", start, truth, count=1, seconds=seconds, low=0.0)
    return read_run_set(folder / "runs", load_boat(start))


def gains_of(runs: RunSet, weight: np.ndarray) -> np.ndarray:
    return recent_gains(runs, soft_weights(weight, runs.boat), thruster_gains(runs.boat, "each"))[0]


def test_a_weak_thruster_is_found_in_the_past_of_a_run_and_predicted_with(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 40.0)
    weight = weights(runs, noise_levels(runs))
    gains = gains_of(runs, weight)
    assert gains[0].tolist() == [1.0, 1.0]
    np.testing.assert_allclose(gains[3:], np.tile([0.4, 1.0], (len(gains) - 3, 1)), atol=0.15)
    found = {one.horizon_s: one.position for one in recent_errors(runs, runs.boat, "each")}
    for one in trivial_predictors(runs, weight)[1:3]:
        assert found[one.horizon_s] < 0.6 * min(one.boat_file, one.constant_velocity, one.no_thrust)


def test_gains_come_from_the_past_alone(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 40.0)
    weight, second = weights(runs, noise_levels(runs)), round(6 * STRETCH / runs.dt)
    other = runs.measured.copy()
    other[:, second:, :2] += 50.0
    changed, gains = gains_of(replace(runs, measured=other), weight), gains_of(runs, weight)
    np.testing.assert_array_equal(changed[:7], gains[:7])
    assert not np.array_equal(changed[7], gains[7])


def test_gains_come_from_after_the_last_gap(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 25.0)
    weight, fifth = weights(runs, noise_levels(runs)), round(STRETCH / runs.dt)
    weight[:, fifth : 2 * fifth] = 0.0
    torn, other = replace(runs, gaps=(Gap(0, fifth, fifth),)), runs.measured.copy()
    other[:, :fifth, :2] += np.linspace(0.0, 50.0, fifth)[:, None]
    gains = gains_of(torn, weight)
    assert gains[2].tolist() == [1.0, 1.0] != gains[4].tolist()
    np.testing.assert_array_equal(gains_of(replace(torn, measured=other), weight)[2:], gains[2:])
    assert not np.array_equal(gains_of(replace(runs, measured=other), weight)[4], gains[4])


def test_each_prediction_is_simulated_once_with_the_gains_of_its_stretch(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 25.0)
    start = restarts(runs, weights(runs, noise_levels(runs)), 0, 1.0)
    assert start is not None
    stretch, hypothesis = start.first // round(STRETCH / runs.dt), thruster_gains(runs.boat, "common")
    gains, before = np.linspace(0.8, 1.2, stretch[-1] + 1)[:, None], start.problem.boat_steps[0]
    ends = predictor(runs, [gains], hypothesis)(0, start)
    problem = start.problem
    assert problem.boat_steps[0] - before == problem.windows.steps.sum() * problem.substeps
    for k, own in enumerate(gains):
        every = start.predict(hypothesis, own)
        np.testing.assert_array_equal(ends[stretch == k], every[stretch == k, -1])


@pytest.mark.parametrize(("kind", "count"), [("twin", 2), ("esso_osaka", 1)])
def test_each_thruster_has_a_gain(kind: str, count: int, tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, kind) if kind == "twin" else kind)
    mean, precision = thruster_gains(boat, "each").prior()
    assert mean.tolist() == [1.0] * count and (precision > 0.0).all()
    assert thruster_gains(boat, "common").size == 1


def test_gains_are_chosen_that_the_training_runs_need(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 40.0)
    chosen, errors = chosen_gains(runs, runs.boat)
    assert chosen == "each"
    assert errors["each"][2].position < 0.6 * errors["none"][2].position


def test_no_gains_are_chosen_where_the_boat_is_right_and_a_gust_moves_it(tmp_path: Path) -> None:
    runs = weedy(tmp_path, 40.0)
    chosen, errors = chosen_gains(runs, load_boat(tmp_path / "weed.yaml"))
    assert chosen == "none"
    exact = [
        one.boat_file
        for one in trivial_predictors(
            replace(runs, boat=load_boat(tmp_path / "weed.yaml")), weights(runs, noise_levels(runs))
        )
    ]
    np.testing.assert_allclose([one.position for one in errors["none"]], exact)
