"""Correlation of the errors of parameters that were fitted together."""

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.estimate import causes_of, correlation
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_the_correlation_is_that_of_the_information_in_the_order_of_the_causes() -> None:
    found = simulated_runs([{"effect": "thrust_scale", "scale": 1.1}], name="swamp-thesis")
    problem = Shooting(found, weights(found, noise_levels(found)), 10.0)
    known = by_label(candidates(found.boat, SECONDS))
    hypothesis = Hypothesis(tuple(known[name] for name in ("thrust_scale", "current", "resistance")))
    at = fit(problem, hypothesis, np.array([1.1, 0.0, 0.0, 1.0]), problem.initial_states())
    thrust, current, resistance = causes_of(problem, at)
    assert len(thrust.parameters) == len(resistance.parameters) == 1 and len(current.parameters) == 2
    held = np.array(correlation(problem, at, [resistance, current, thrust]))
    np.testing.assert_array_equal(held, held.T)
    np.testing.assert_array_equal(np.diag(held), 1.0)
    assert np.linalg.eigvalsh(held).min() > -1e-9
    spread = np.sqrt(np.diag(at.covariance))
    of_x = at.covariance / np.outer(spread, spread)
    order = [3, 1, 2, 0]
    np.testing.assert_allclose(held, of_x[np.ix_(order, order)], atol=1e-4)
    assert abs(held[0, 1]) > 0.3  # both change the steady speed
    assert correlation(problem, at, [thrust]) == [[1.0]]
    assert correlation(problem, at, []) == []
