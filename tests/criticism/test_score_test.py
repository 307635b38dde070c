"""Score tests: the expected fall of chi2 by each effect, without a fit."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.criticism.selection.score_test import score_tests
from tests.support.criticism import SECONDS, simulated_runs

FAILURE = "thruster_failure bp"


@pytest.mark.parametrize("boat", ["swamp", "swamp-light"])
def test_a_thruster_that_failed_early_comes_first_and_near_its_fit(boat: str) -> None:
    """The boat file alone is far from the data, its fitted states are bent for want of the failure."""
    failed = {"effect": "thruster_failure", "thruster": "bp", "time": 5.0}
    runs = simulated_runs([failed], velocities=False, name=boat)
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    every = by_label(candidates(runs.boat, SECONDS))
    problem = continuation.problems[0]
    first, *_ = score_tests(problem, continuation.boat_file(0), list(every.values()))
    assert first.instance.label == FAILURE
    made = fit(problem, first.hypothesis, first.x, first.states)
    np.testing.assert_allclose(made.x, [5.0], atol=0.1)
    assert first.expected_chi2 < 1.5 * made.chi2


def test_a_swap_is_scored_from_the_measured_states_where_those_of_the_fit_diverge() -> None:
    found = simulated_runs([{"effect": "channel_swap", "thruster": ["bs", "sp"]}])
    problem = continuation_of(found, weights(found, noise_levels(found))).problems[0]
    nothing = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), 1)
    assert nothing.chi2 > 10.0 * problem.samples
    turning = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1e5])  # rad/s
    bent = replace(nothing, states=nothing.states + turning)
    (score,) = score_tests(problem, bent, [by_label(candidates(found.boat, SECONDS))["channel_swap bs sp"]])
    assert score.expected_chi2 < 2.0 * problem.samples
