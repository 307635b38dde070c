"""Mean and spread of values that differ between runs."""

import numpy as np
import pytest

from swamp_rl.criticism.nuisance.random_effect import random_effect

SCALE = np.array([5.0, 5.0])


def test_equal_errors_give_the_textbook_variance_component() -> None:
    values = np.array([[3.0, 1.0], [5.0, -1.0], [4.0, 3.0], [2.0, 0.0]])
    found = random_effect(values, 0.25 * np.eye(8), SCALE)
    squares = ((values - values.mean(axis=0)) ** 2).sum()
    assert 5.0 * found.spread == pytest.approx(np.sqrt(squares / 6.0 - 0.25), rel=1e-4)
    np.testing.assert_allclose(found.mean, values.mean(axis=0))
    assert 0.0 < found.low < found.spread < found.high


def test_runs_that_agree_have_no_spread_and_the_mean_of_a_shared_value() -> None:
    found = random_effect(np.ones((5, 2)), 0.01 * np.eye(10), SCALE)
    assert found.spread == found.low == 0.0
    assert 0.0 < 5.0 * found.high < 0.1
    np.testing.assert_allclose(found.covariance, 0.002 * np.eye(2), rtol=1e-6)


def test_the_interval_of_the_spread_holds_the_truth_as_often_as_it_says() -> None:
    rng, noise, held = np.random.default_rng(1), 0.2 * np.eye(10) + 0.1, []
    for _ in range(100):
        values = rng.normal([2.0, -1.0], 1.0, (5, 2))
        values += rng.multivariate_normal(np.zeros(10), noise).reshape(5, 2)
        found = random_effect(values, noise, SCALE)
        held.append(5.0 * found.low < 1.0 < 5.0 * found.high)
    assert 0.88 <= np.mean(held) <= 0.99


def test_a_run_that_is_known_badly_counts_little() -> None:
    errors = np.array([0.01, 0.01, 0.01, 100.0])
    found = random_effect(np.array([[1.0], [1.2], [0.8], [50.0]]), np.diag(errors**2), np.ones(1))
    assert found.mean[0] == pytest.approx(1.0, abs=0.05)
