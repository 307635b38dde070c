"""Folds of the cross-validation, and restarts of fits that have not converged."""

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.likelihood.cross_validation import folds_of
from swamp_rl.criticism.model.candidates import Hypothesis, candidates
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
