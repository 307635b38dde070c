"""The sign-flip test against closed forms, scipy and its own promise; Holm against his definition."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest, permutation_test

from swamp_rl.evaluation import holm, sign_flip_test


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_darwins_maize_has_the_exact_p_value_of_fisher_1935() -> None:
    # Crossed less self-fertilised plants in eighths of an inch; Fisher counts 863 of 32768 patterns of signs
    # at least as far from zero on one side, 5.267 per cent on both.
    maize = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]
    drawn = sign_flip_test(maize, rng(1), resamples=99_999)
    assert drawn == pytest.approx(2 * 863 / 2**15, abs=4 * np.sqrt(0.0527 * 0.9473 / 1e5))
    patterns = np.array(list(itertools.product((1, -1), repeat=15))) @ np.array(maize)
    assert (patterns >= sum(maize)).sum() == 863


def test_few_differences_try_every_pattern_of_signs() -> None:
    # All five positive: one pattern of 32 is as high, one as low.
    assert sign_flip_test([1.0, 2.0, 3.0, 4.0, 5.0], rng()) == pytest.approx(2 / 32)
    assert sign_flip_test([1.0, 2.0, 3.0, 4.0, 5.0], rng(), greater=True) == pytest.approx(1 / 32)


def test_successes_compare_as_mcnemars_exact_test() -> None:
    both_or_neither, only_a, only_b = np.zeros(400), np.ones(30), -np.ones(12)
    p = sign_flip_test(np.concatenate([both_or_neither, only_a, only_b]), rng())
    assert p == pytest.approx(binomtest(30, 42).pvalue, rel=1e-12)


def test_many_differences_agree_with_scipys_permutation_test() -> None:
    d = rng(3).normal(0.12, 1.0, 200)
    theirs = permutation_test((d,), np.mean, permutation_type="samples", n_resamples=9999, rng=rng(4)).pvalue
    assert sign_flip_test(d, rng(5)) == pytest.approx(theirs, abs=4 * np.sqrt(2 * theirs / 9999))


def test_under_the_null_one_test_in_twenty_falls_below_five_percent() -> None:
    generator = rng(6)
    below = sum(
        sign_flip_test(generator.laplace(size=40), generator, resamples=499) <= 0.05 for _ in range(800)
    )
    assert below / 800 == pytest.approx(0.05, abs=3 * np.sqrt(0.05 * 0.95 / 800))


def test_the_test_is_of_the_seed_alone_and_never_zero() -> None:
    d = rng(7).normal(5.0, 1.0, 50)
    assert sign_flip_test(d, rng(8), resamples=999) == 1 / 1000
    mixed = rng(7).normal(0.1, 1.0, 50)
    assert sign_flip_test(mixed, rng(9)) == sign_flip_test(mixed, rng(9))


def test_missing_pairs_are_left_out_and_no_difference_is_no_evidence() -> None:
    assert sign_flip_test([1.0, np.nan, 2.0, 3.0], rng()) == sign_flip_test([1.0, 2.0, 3.0], rng())
    assert sign_flip_test([0.0, 0.0], rng()) == 1.0


def test_holm_multiplies_the_smallest_by_their_number_and_never_falls() -> None:
    # 0.01 x 4, 0.02 x 3, 0.03 x 2 (not below the one before it), 0.5 x 1, back in their places.
    assert holm([0.5, 0.01, 0.03, 0.02]) == pytest.approx([0.5, 0.04, 0.06, 0.06])


def test_holm_does_not_count_a_comparison_that_was_not_made() -> None:
    corrected = holm([0.01, float("nan"), 0.04])
    assert (corrected[0], corrected[2]) == (pytest.approx(0.02), pytest.approx(0.04))
    assert np.isnan(corrected[1])


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_holm_lies_between_no_correction_and_bonferronis_and_keeps_the_order(p: list[float]) -> None:
    corrected = np.array(holm(p))
    bonferroni = np.minimum(np.array(p) * len(p), 1.0)
    assert (corrected >= np.array(p) - 1e-12).all() and (corrected <= bonferroni + 1e-12).all()
    assert (np.diff(corrected[np.argsort(p, kind="stable")]) >= 0.0).all()


def test_holm_keeps_the_chance_of_any_false_alarm_within_five_percent() -> None:
    p = rng(10).random((4000, 8))
    alarms = np.mean([min(holm(row)) <= 0.05 for row in p])
    # Independent true nulls: 1 - (1 - 0.05 / 8)^8.
    assert alarms == pytest.approx(1 - (1 - 0.05 / 8) ** 8, abs=3 * np.sqrt(0.05 * 0.95 / 4000))
