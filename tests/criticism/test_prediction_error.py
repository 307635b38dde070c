"""Gain on held-out runs: paired, in independent blocks, with intervals that hold for few blocks."""

import math

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.prediction_error import Errors, blocks_of, change, expanded_tail, gains
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from tests.support.criticism import SECONDS, SIGMA, simulated_runs

pytestmark = pytest.mark.numerical


def test_few_blocks_are_cut_at_the_tail_that_students_t_gives_and_many_at_the_plain_one() -> None:
    # Hesterberg 2015: the normal quantile at the tail is sqrt(n / (n - 1)) of t's; t(0.975; 4) = 2.776445
    exponent = math.sqrt(5 / 4) * 2.776445
    assert expanded_tail(5) == pytest.approx(0.5 * math.erfc(exponent / math.sqrt(2)), rel=1e-3)
    assert expanded_tail(100_000) == pytest.approx(0.025, rel=1e-3)


def test_intervals_by_run_cover_where_restarts_of_a_run_share_their_luck() -> None:
    rng = np.random.default_rng(0)
    runs, each = 6, 12
    block = np.repeat(np.arange(runs), each)
    covered = {"by run": 0, "by restart": 0}
    for _ in range(100):
        # squared errors before and after differ by a luck of the run's own: the truth is 4 against 1
        luck = rng.uniform(0.0, 2.0, runs)[block]
        after = rng.normal(size=(len(block), 1))
        before = 2.0 * np.sqrt(luck)[:, None] * after
        for how, by in (("by run", block), ("by restart", np.arange(len(block)))):
            found = change(before, after, by, rng)
            assert found is not None
            covered[how] += found.ci95[0] <= 1.0 <= found.ci95[1]
    assert covered["by run"] / 100 > 0.9
    assert covered["by restart"] / 100 < 0.8


def test_four_runs_are_blocks_and_fewer_are_cut_in_stretches() -> None:
    def errors(runs: int) -> Errors:
        return Errors(np.zeros((24, 6)), np.arange(24) % runs, np.repeat(np.arange(6) * 10.0, 4))

    block, called = blocks_of(errors(4), 5.0)
    assert called == "runs" and len(set(block)) == 4
    block, called = blocks_of(errors(2), 5.0)
    assert called == "stretches of 20 s" and len(set(block)) == 6  # 60 s of two runs
    assert blocks_of(errors(2), 30.0)[1] == "stretches of 60 s"


def test_a_quantity_without_two_blocks_has_no_interval() -> None:
    rng = np.random.default_rng(0)
    error = np.ones((4, 1))
    assert change(error, error, np.zeros(4, int), rng) is None
    assert change(error * np.nan, error, np.arange(4), rng) is None


def test_the_right_cause_brings_the_error_down_to_the_noise_and_a_mute_channel_stays_out() -> None:
    found = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.6}], velocities=False)
    instance = by_label(candidates(found.boat, SECONDS))["thruster_gain bs"]
    weight = weights(found, noise_levels(found))
    made = gains(found, weight, Hypothesis((instance,)), np.full((3, 1), 0.6), np.random.default_rng(0))
    assert [one.horizon_s for one in made] == [1.0, 5.0, 10.0, 30.0]
    ten = made[2]
    assert ten.surge_rmse_m_s is None and ten.heading_rmse_rad is not None
    assert ten.heading_rmse_rad.ci95[0] > 0.0
    assert ten.heading_rmse_rad.after < 0.3 * ten.heading_rmse_rad.before
    assert made[0].position_rmse_m is not None
    assert made[0].position_rmse_m.after == pytest.approx(np.hypot(*SIGMA[:2]), rel=0.35)
