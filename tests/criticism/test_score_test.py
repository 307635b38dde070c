"""Score tests: the expected fall of chi2 by each effect, without a fit."""

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import by_label, candidates
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
