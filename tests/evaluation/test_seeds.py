"""Statistics over training seeds, against closed forms, scipy and their own coverage."""

import numpy as np
import pytest
from scipy.stats import bootstrap, mannwhitneyu, trim_mean

from swamp_rl.evaluation import (
    common_steps,
    curve_band,
    interquartile_mean,
    mean_over_tasks,
    probability_of_improvement,
)

pytestmark = pytest.mark.numerical


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_interquartile_mean_is_the_mean_of_the_middle_half() -> None:
    scores = np.array([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0], [6.0, 100.0]])
    assert interquartile_mean(scores, rng()).value == pytest.approx(np.mean([2.0, 3.0, 4.0, 5.0]))


def test_mean_over_tasks_leaves_out_no_task() -> None:
    tasks = np.array([1.0, 0.9, 0.5, 0.0])
    for seeds in (1, 4):
        found = mean_over_tasks(np.tile(tasks, (seeds, 1)), rng())
        assert found.value == pytest.approx(tasks.mean())
    assert (found.low, found.high) == pytest.approx((tasks.mean(), tasks.mean()))


def test_stratified_interval_agrees_with_scipys_bootstrap_of_separate_samples() -> None:
    scores = rng(1).beta(8.0, 2.0, (10, 3))

    def pooled(*columns: np.ndarray, axis: int = -1) -> np.ndarray:
        return trim_mean(np.concatenate(columns, axis=axis), 0.25, axis=axis)

    theirs = bootstrap(tuple(scores.T), pooled, n_resamples=8000, method="percentile", rng=rng(2))
    ours = interquartile_mean(scores, rng(3), resamples=8000)
    ends = theirs.confidence_interval
    assert (ours.low, ours.high) == pytest.approx((ends.low, ends.high), abs=0.004)


def test_interquartile_interval_covers_the_truth_nearly_as_often_as_it_says() -> None:
    generator, covered = rng(4), 0
    for _ in range(300):
        found = interquartile_mean(generator.normal(size=(10, 3)), generator, resamples=400)
        covered += found.low <= 0.0 <= found.high
    # Ten seeds: the percentile bootstrap is known to fall short of 0.95 by a few points.
    assert 0.88 <= covered / 300 <= 0.98


def test_probability_of_improvement_is_mann_whitneys_u_over_the_pairs() -> None:
    a, b = rng(5).integers(0, 6, (7, 2)).astype(float), rng(6).integers(0, 6, (5, 2)).astype(float)
    u = [mannwhitneyu(a[:, task], b[:, task]).statistic / 35 for task in range(2)]
    assert probability_of_improvement(a, b, rng()).value == pytest.approx(np.mean(u))


def test_probability_of_improvement_of_equals_is_a_half_and_of_the_better_one_is_one() -> None:
    scores = rng(7).random((6, 2))
    assert probability_of_improvement(np.ones((4, 1)), np.ones((3, 1)), rng()).value == 0.5
    sure = probability_of_improvement(scores + 1.0, scores, rng())
    assert (sure.value, sure.low, sure.high) == (1.0, 1.0, 1.0)
    back = probability_of_improvement(scores[:3], scores[3:], rng())
    assert probability_of_improvement(scores[3:], scores[:3], rng()).value == pytest.approx(1 - back.value)


def test_one_seed_has_a_value_and_no_interval() -> None:
    found = interquartile_mean([[0.9, 0.7]], rng())
    assert found.value == pytest.approx(0.8)
    assert np.isnan(found.low) and np.isnan(found.high)
    _, low, high = curve_band([[0.1, 0.2]], rng())
    assert np.isnan(low).all() and np.isnan(high).all()


def test_scores_that_are_no_table_are_refused() -> None:
    with pytest.raises(ValueError, match="seeds, tasks"):
        interquartile_mean([0.1, 0.2], rng())
    with pytest.raises(ValueError, match="2 and 1 tasks"):
        probability_of_improvement([[1.0, 2.0]], [[1.0]], rng())


def test_curve_band_of_curves_that_agree_has_no_width() -> None:
    curve = np.linspace(0.0, 1.0, 5)
    centre, low, high = curve_band(np.tile(curve, (10, 1)), rng())
    assert np.allclose([centre, low, high], curve)


def test_curve_band_covers_the_true_curve_at_each_point() -> None:
    generator, truth = rng(8), np.linspace(0.2, 0.9, 6)
    covered = []
    for _ in range(200):
        _, low, high = curve_band(truth + 0.1 * generator.normal(size=(10, 6)), generator, resamples=400)
        covered.append((low <= truth) & (truth <= high))
    assert 0.86 <= np.mean(covered) <= 0.98


def test_curves_of_different_steps_meet_on_the_coarser_grid() -> None:
    steps, values = common_steps([([0, 10, 20, 30], [0.0, 1.0, 2.0, 3.0]), ([0, 20, 40], [0.0, 4.0, 8.0])])
    assert steps.tolist() == [0.0, 20.0]
    assert values.tolist() == [[0.0, 2.0], [0.0, 4.0]]
    with pytest.raises(ValueError, match="in common"):
        common_steps([([0, 1], [0.0, 0.0]), ([5, 6], [0.0, 0.0])])
