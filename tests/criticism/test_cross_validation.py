"""Folds of the cross-validation, and restarts of fits that have not converged."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.likelihood.cross_validation import (
    bootstrap_quantile,
    folds_of,
    heldout_loss,
    heldout_numbers,
)
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.criticism.selection.score_test import score_tests
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def windows(*counts: int) -> Windows:
    """Runs of so many windows, one after another."""
    run = np.repeat(np.arange(len(counts)), counts)
    first = np.concatenate([50 * np.arange(count) for count in counts])
    empty = np.zeros((len(run), 51, 6))
    return Windows(run, first, np.full(len(run), 50), empty, empty, 0, 51)


def test_enough_runs_are_held_out_whole() -> None:
    assert folds_of(windows(2, 2, 2, 2)).tolist() == [0, 0, 1, 1, 2, 2, 3, 3]


def test_of_few_runs_halves_are_held_out_and_of_one_run_each_window() -> None:
    assert folds_of(windows(4, 2)).tolist() == [0, 0, 1, 1, 2, 3]
    assert folds_of(windows(3)).tolist() == [0, 1, 2]


GAINS = {
    "normal": np.random.default_rng(0).normal(2.0, 3.0, 20),
    "skewed": np.random.default_rng(1).exponential(1.0, 15) ** 2 - 0.5,
    "heavy-tailed": np.random.default_rng(2).standard_t(3, 80),
}


@pytest.mark.parametrize("name", GAINS)
@pytest.mark.parametrize("tail", [0.025, 1e-3])
def test_the_bootstrap_quantile_is_that_of_many_draws(name: str, tail: float) -> None:
    gains, rng = GAINS[name], np.random.default_rng(3)
    shares = np.full(len(gains), 1.0 / len(gains))
    sums = rng.multinomial(len(gains), shares, 100_000) @ gains
    assert bootstrap_quantile(gains, tail) == pytest.approx(np.quantile(sums, tail), abs=0.02 * np.ptp(sums))


def test_gains_in_few_blocks_may_all_be_missed_by_a_draw() -> None:
    assert bootstrap_quantile(np.array([0.0] * 15 + [10.0, 20.0]), 1e-3) == 0.0
    assert bootstrap_quantile(np.array([1.0, -2.0, 4.0]), 1e-4) == -6.0


def test_equal_gains_have_no_interval() -> None:
    assert bootstrap_quantile(np.full(8, 2.5), 1e-4) == 20.0


@pytest.mark.parametrize("moment", [2.5, 6.0])
def test_an_asymmetric_hull_is_fitted_though_windows_diverge(moment: float) -> None:
    found = simulated_runs(
        [{"effect": "hull_asymmetry", "yaw_moment": moment}], velocities=False, name="swamp-thesis"
    )
    continuation = continuation_of(found, weights(found, noise_levels(found)))
    nothing = continuation.fit(0, Hypothesis(), np.zeros(0))
    instance = next(one for one in candidates(found.boat, SECONDS) if one.label == "hull_asymmetry")
    start = score_tests(continuation.problems[0], nothing, [instance])[0]
    made = continuation.fit(0, start.hypothesis, start.x, start.states)
    if continuation.not_converged(made, nothing.chi2, start.expected_chi2):
        made = continuation.restarted(made)
    assert made.chi2 < 1.1 * continuation.problems[0].samples
    assert made.x == pytest.approx([moment], rel=0.01)


def test_numbers_and_losses_of_held_out_runs_are_finite_where_a_jacobian_diverged() -> None:
    found = simulated_runs([{"effect": "resistance", "scale": 1.2}])
    continuation = continuation_of(found, weights(found, noise_levels(found)))
    hypothesis = Hypothesis((by_label(candidates(found.boat, SECONDS))["resistance"],))
    made = continuation.fit(0, hypothesis, np.array([1.2]))
    first = continuation.problems[0].windows.run == 0
    information = np.where(first[:, None, None], np.nan, made.normal.information)
    diverged = replace(made, normal=replace(made.normal, information=information))
    numbers = heldout_numbers(continuation.problems[0], diverged)
    known = heldout_numbers(continuation.problems[0], made)
    assert numbers[0] == pytest.approx(known[0])
    assert numbers[1:].ravel() == pytest.approx(np.repeat(made.x, len(numbers) - 1))
    losses = heldout_loss(continuation.problems[0], diverged)
    assert losses[first] == pytest.approx(made.loss[first])
    assert np.isfinite(losses).all()
