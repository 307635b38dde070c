"""The intervals, against published values, closed forms and their own coverage."""

import sys

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import binomtest

from swamp_rl.evaluation.statistics import (
    Interval,
    paired_difference,
    success_difference,
    success_difference_of_seeds,
    wilson,
    with_episodes,
)


@pytest.mark.parametrize(
    ("successes", "n", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_agrees_with_table_1_of_newcombe_1998(successes: int, n: int, low: float, high: float) -> None:
    interval = wilson(successes, n)
    assert interval.value == successes / n
    assert (interval.low, interval.high) == (pytest.approx(low, abs=5e-5), pytest.approx(high, abs=5e-5))


def test_wilson_at_all_successes_is_n_over_n_plus_z_squared() -> None:
    interval = wilson(1000, 1000)
    assert interval.low == pytest.approx(1000 / (1000 + 1.959964**2), rel=1e-9)
    assert interval.high == 1.0


def test_wilson_has_the_bits_of_scipy_whose_statistics_it_does_not_import(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pairs = [(successes, n) for n in (1, 7, 20, 263) for successes in range(n + 1)]
    theirs = [binomtest(*pair).proportion_ci(0.95, method="wilson") for pair in pairs]
    monkeypatch.setitem(sys.modules, "scipy.stats", None)  # half a second to import
    ours = [wilson(*pair) for pair in pairs]
    assert [(one.low, one.high) for one in ours] == [(one.low, one.high) for one in theirs]


def test_wilson_refuses_more_successes_than_episodes() -> None:
    with pytest.raises(ValueError):
        wilson(3, 2)


def outcomes(both: int, only_a: int, only_b: int, neither: int) -> tuple[np.ndarray, np.ndarray]:
    """(n,) bool: the episodes in which a succeeds, and those in which b does."""
    counts = (both, only_a, only_b, neither)
    return np.repeat([True, True, False, False], counts), np.repeat([True, False, True, False], counts)


def test_the_intervals_of_a_rate_and_of_a_difference_have_one_normal_quantile() -> None:
    z2 = ndtri(0.975) ** 2
    assert wilson(0, 20).high == pytest.approx(z2 / (20 + z2), rel=1e-14)
    assert success_difference(*outcomes(0, 0, 0, 20)).high == pytest.approx(z2 / (20 + z2), rel=1e-10)


@pytest.mark.parametrize("both", [0, 7, 20])
def test_pilots_that_agree_in_every_episode_may_still_differ_by_z_squared_over_n_plus_z_squared(
    both: int,
) -> None:
    interval = success_difference(*outcomes(both, 0, 0, 20 - both))
    half = 1.959964**2 / (20 + 1.959964**2)
    assert (interval.value, interval.low, interval.high) == pytest.approx((0.0, -half, half), rel=1e-6)


def test_pilots_that_differ_in_every_episode_have_an_interval_of_some_width() -> None:
    interval = success_difference(*outcomes(0, 20, 0, 0))
    least = (20 - 1.959964**2) / (20 + 1.959964**2)
    assert (interval.value, interval.low, interval.high) == pytest.approx((1.0, least, 1.0), rel=1e-6)
    swapped = success_difference(*outcomes(0, 0, 20, 0))
    assert (swapped.value, swapped.low, swapped.high) == pytest.approx((-1.0, -1.0, -least), rel=1e-6)


@pytest.mark.parametrize("only_a", range(0, 15))
def test_the_interval_of_success_leaves_out_zero_where_mcnemars_score_test_rejects(only_a: int) -> None:
    interval = success_difference(*outcomes(10, only_a, 4, 6))
    rejected = (only_a - 4) ** 2 > 1.959964**2 * (only_a + 4)
    assert rejected == (interval.low > 0.0 or interval.high < 0.0)
    assert -1.0 <= interval.low < interval.value < interval.high <= 1.0


@pytest.mark.parametrize(("agree", "n"), [(0.98, 20), (0.7, 20), (0.9, 100)])
def test_the_interval_of_success_covers_the_truth_nineteen_times_in_twenty(agree: float, n: int) -> None:
    rng, covered = np.random.default_rng(8), 0
    chances = (0.5 * agree, 0.75 * (1.0 - agree), 0.25 * (1.0 - agree), 0.5 * agree)
    for _ in range(400):
        interval = success_difference(*outcomes(*rng.multinomial(n, chances)))
        covered += interval.low <= chances[1] - chances[2] <= interval.high
    assert covered / 400 >= 0.93


def test_the_interval_of_six_paired_costs_covers_the_truth_about_nineteen_times_in_twenty() -> None:
    rng = np.random.default_rng(9)
    found = [paired_difference(rng.normal(2.0, 1.0, 6), np.zeros(6), rng, 1000) for _ in range(400)]
    assert np.mean([one.low <= 2.0 <= one.high for one in found]) >= 0.91


def test_one_pair_of_costs_has_no_interval() -> None:
    interval = paired_difference([3.0], [1.0], np.random.default_rng(0))
    assert (interval.value, interval.n) == (2.0, 1) and np.isnan([interval.low, interval.high]).all()


def test_seeds_that_agree_in_every_episode_may_still_differ_as_clopper_and_pearson_have_it() -> None:
    agreed = np.full(50, 0.8)
    found = success_difference_of_seeds(agreed, agreed, np.random.default_rng(0))
    end = 1.0 - 0.025 ** (1 / 50)
    assert found.value == 0.0
    assert (-found.low, found.high) == (pytest.approx(end, rel=0.1), pytest.approx(end, rel=0.1))


def test_the_difference_of_one_seed_from_a_pilot_that_always_fails_has_the_ends_of_clopper_and_pearson() -> (
    None
):
    won = np.repeat([1.0, 0.0], [30, 20])
    found = success_difference_of_seeds(won, np.zeros(50), np.random.default_rng(1))
    theirs = binomtest(30, 50).proportion_ci(0.95, method="exact")
    assert found.value == pytest.approx(0.6)
    assert found.high == pytest.approx(theirs.high, abs=0.01)
    assert found.low < theirs.low  # a difference may be -1, a rate may not


def test_the_difference_over_seeds_covers_the_truth_at_least_nineteen_times_in_twenty() -> None:
    rng, covered = np.random.default_rng(2), 0
    for _ in range(300):
        hard = rng.random(40)[:, None]  # episodes are easy or hard for all seeds of both pilots
        a, b = (rng.random((40, 3)) < hard**power for power in (0.2, 0.5))
        found = success_difference_of_seeds(a.mean(axis=1), b.mean(axis=1), rng)
        covered += found.low <= 1 / 1.2 - 1 / 1.5 <= found.high
    assert covered / 300 >= 0.93


def test_a_rate_over_seeds_that_all_succeed_has_the_width_of_its_episodes() -> None:
    assert with_episodes(Interval(1.0, 1.0, 1.0, 5), 100).low == pytest.approx(wilson(100, 100).low)
    wide = with_episodes(Interval(0.5, 0.2, 0.8, 5), 100)
    assert wide.high == pytest.approx(0.5 + np.hypot(0.3, wilson(50, 100).high - 0.5))
    assert with_episodes(Interval(0.1, 0.0, 0.9, 5), 10).low == 0.0
    assert np.isnan(with_episodes(Interval(0.5, np.nan, np.nan, 1), 10).low)


def test_paired_difference_of_a_constant_shift_is_that_shift_exactly() -> None:
    b = np.random.default_rng(1).normal(50.0, 9.0, 200)
    interval = paired_difference(b + 2.0, b, np.random.default_rng(2))
    assert (interval.value, interval.low, interval.high) == pytest.approx((2.0, 2.0, 2.0), abs=1e-12)


def test_paired_difference_has_the_width_of_the_normal_theory() -> None:
    difference = np.random.default_rng(3).normal(0.5, 2.0, 1000)
    interval = paired_difference(difference, np.zeros(1000), np.random.default_rng(4), resamples=4000)
    half = 1.96 * difference.std(ddof=1) / np.sqrt(1000)
    assert interval.value == pytest.approx(difference.mean())
    assert (interval.high - interval.low) / 2 == pytest.approx(half, rel=0.06)


def test_paired_difference_covers_the_truth_about_nineteen_times_in_twenty() -> None:
    rng = np.random.default_rng(5)
    covered = 0
    for _ in range(300):
        a = rng.random(80) < 0.8
        b = np.where(rng.random(80) < 0.5, a, rng.random(80) < 0.6)
        interval = paired_difference(a, b, rng, resamples=300)
        covered += interval.low <= 0.1 <= interval.high
    assert 0.90 <= covered / 300 <= 0.985


def test_paired_difference_leaves_out_pairs_with_a_missing_value() -> None:
    a, b = np.array([1.0, np.nan, 3.0]), np.array([0.0, 5.0, 2.0])
    assert paired_difference(a, b, np.random.default_rng(0)).n == 2
    assert np.isnan(paired_difference(a[1:2], b[1:2], np.random.default_rng(0)).value)


def test_paired_difference_swapped_changes_sign() -> None:
    a, b = np.random.default_rng(6).random((2, 100))
    forward = paired_difference(a, b, np.random.default_rng(7))
    back = paired_difference(b, a, np.random.default_rng(7))
    assert (back.low, back.high) == pytest.approx((-forward.high, -forward.low))


def test_paired_difference_refuses_arrays_of_different_episodes() -> None:
    with pytest.raises(ValueError, match="one number per episode"):
        paired_difference(np.zeros(3), np.zeros(4), np.random.default_rng(0))
