"""The interval over trainings and episodes: closed forms, and coverage where naive ones fail."""

import numpy as np
import pytest

from swamp_rl.evaluation.crossed import crossed_mean


def test_the_mean_is_over_all_that_is_known() -> None:
    values = np.array([[1.0, np.nan], [3.0, 5.0]])
    found = crossed_mean(values, np.random.default_rng(0))
    assert (found.value, found.n) == (3.0, 2)
    assert found.low <= 3.0 <= found.high


def test_alike_everywhere_leaves_no_width_and_nothing_known_no_value() -> None:
    alike = crossed_mean(np.full((4, 6), 0.7), np.random.default_rng(0))
    assert (alike.low, alike.high) == (pytest.approx(0.7), pytest.approx(0.7))
    assert np.isnan(crossed_mean(np.full((4, 6), np.nan), np.random.default_rng(0)).value)


def test_values_without_episodes_are_refused() -> None:
    with pytest.raises(ValueError, match="trainings, episodes"):
        crossed_mean([1.0, 2.0], np.random.default_rng(0))


def test_trainings_that_differ_widen_the_interval_as_much_as_they_should() -> None:
    # All of the variance between trainings: the interval is that of their means.
    means = np.random.default_rng(1).normal(size=40)
    found = crossed_mean(np.repeat(means[:, None], 50, axis=1), np.random.default_rng(2), resamples=8000)
    half = 1.96 * means.std() / np.sqrt(40)
    assert (found.high - found.low) / 2.0 == pytest.approx(half, rel=0.06)


def test_it_covers_the_truth_where_trainings_and_episodes_both_differ() -> None:
    rng, covered = np.random.default_rng(3), 0
    for _ in range(300):
        values = rng.normal(size=(10, 1)) + rng.normal(size=(1, 60)) + 2.0 * rng.normal(size=(10, 60))
        found = crossed_mean(values, rng, resamples=400)
        covered += found.low <= 0.0 <= found.high
    assert 0.88 <= covered / 300 <= 0.985
