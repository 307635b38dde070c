"""Gauss-Markov measurement noise."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import Gap
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.inference.estimate import causes_of
from swamp_rl.criticism.likelihood.gauss_markov import fit_gauss_markov, kalman_filter, white_noise
from swamp_rl.criticism.model.candidates import Hypothesis, candidates
from swamp_rl.criticism.selection import model_selection
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.model_selection import select_model
from tests.support.criticism import DT, SECONDS, gauss_markov_noise, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def windows(count: int, rows: int) -> Windows:
    """Windows of unit weight with a few samples missing."""
    weight = np.ones((count, rows, 6))
    weight[0, 3:5, 0] = 0.0
    own = np.arange(count)
    return Windows(own, 0 * own, np.full(count, rows - 1), np.zeros((count, rows, 6)), weight, 0, rows)


@pytest.mark.parametrize("white", [1.0, 0.4])
def test_the_filter_gives_the_likelihood_of_the_whole_covariance(white: float) -> None:
    rows, size, seconds = 12, 2.0, 0.7
    slow = white_noise()
    slow[0] = size, seconds, white
    cut = windows(2, rows)
    made = kalman_filter(cut, slow, DT)
    values = np.random.default_rng(0).standard_normal((1, 2, rows, 6))
    values *= cut.weight
    innovation = made.whitened(values.copy())[0, :, :, 0]
    apart = np.abs(np.subtract.outer(np.arange(rows), np.arange(rows))) * DT
    covariance = white**2 * np.eye(rows) + size**2 * np.exp(-apart / seconds)
    for w in range(2):
        seen = cut.weight[w, :, 0] > 0
        truth = multivariate_normal(cov=covariance[np.ix_(seen, seen)]).logpdf(values[0, w, seen, 0])
        scale = made.scale[w, seen, 0]
        result = -0.5 * (innovation[w, seen] ** 2).sum() + np.log(scale).sum()
        assert result - 0.5 * seen.sum() * np.log(2 * np.pi) == pytest.approx(truth)
    assert made.whitened(values.copy())[0, :, :, 1:] == pytest.approx(values[0, :, :, 1:])


@pytest.mark.parametrize("channels", [(0, 1), (3,)])
def test_size_and_time_constant_are_estimated_and_are_zero_for_white_noise(channels: tuple[int]) -> None:
    rng = np.random.default_rng(1)
    cut = windows(80, 400)
    values = rng.standard_normal(cut.weight.shape)
    for channel in channels:
        values[..., channel] += gauss_markov_noise(rng, (80, 400), 3.4, 17.0)
    slow = fit_gauss_markov(cut, values * cut.weight, DT)
    assert np.flatnonzero(slow[:, 0]).tolist() == list(channels)
    assert (slow[channels, :] == slow[channels[0]]).all()
    size, seconds, white = slow[channels[0]]
    assert white == 1.0
    assert 0.8 * 3.4 < size < 1.25 * 3.4
    assert 0.7 * 17.0 < seconds < 1.4 * 17.0


def test_white_noise_beside_a_process_may_be_less_than_third_differences_say() -> None:
    rng = np.random.default_rng(5)
    cut = windows(60, 300)
    values = 0.3 * rng.standard_normal(cut.weight.shape)
    for channel in (0, 1):
        values[..., channel] += gauss_markov_noise(rng, (60, 300), 8.0, 20.0)
    size, seconds, white = fit_gauss_markov(cut, values * cut.weight, DT, least_white=0.05)[0]
    assert size == pytest.approx(8.0, rel=0.15)
    assert seconds == pytest.approx(20.0, rel=0.3)
    assert white == pytest.approx(0.3, rel=0.1)
    *_, held = fit_gauss_markov(cut, values * cut.weight, DT)[0]
    assert held == 1.0


def test_a_position_that_was_not_measured_has_no_noise() -> None:
    rng = np.random.default_rng(1)
    cut = windows(10, 400)
    cut.weight[..., 1] = 0.0
    values = rng.standard_normal(cut.weight.shape)
    values[..., 0] += gauss_markov_noise(rng, (10, 400), 4.0, 10.0)
    slow = fit_gauss_markov(cut, values * cut.weight, DT)
    assert np.flatnonzero(slow[:, 0]).tolist() == [0]


def test_noise_of_the_receiver_is_found_where_either_position_alone_does_not_show_it() -> None:
    together, alone = 0, 0
    for seed in range(6):
        rng = np.random.default_rng(seed)
        cut = windows(4, 200)
        values = rng.standard_normal(cut.weight.shape)
        for channel in (0, 1, 3):
            values[..., channel] += gauss_markov_noise(rng, (4, 200), 0.25, 10.0)
        north, east, _, surge, *_ = fit_gauss_markov(cut, values * cut.weight, DT)[:, 0] > 0.0
        together, alone = together + (north and east), alone + surge
    assert alone <= 2
    assert together >= 4


def test_position_noise_is_no_cause_and_hides_none() -> None:
    for effects in ([], [{"effect": "yaw_damping", "scale": 1.6}]):
        found = simulated_runs(effects, seed=12)
        errors = gauss_markov_noise(np.random.default_rng(2), (3, found.measured.shape[1], 2), 0.3, 20.0)
        measured = found.measured.copy()
        measured[..., :2] += errors
        found = replace(found, measured=measured, gaps=(Gap(0, 150, 1),))
        possible = [
            instance
            for instance in candidates(found.boat, SECONDS)
            if instance.effect.name in ("external_force", *(effect["effect"] for effect in effects))
        ]
        weight = weights(found, noise_levels(found))
        with_noise, continuation, selection = select_model(found, weight, possible, None)
        assert selection.adequate
        names = [instance.effect.name for instance in selection.winner.hypothesis.instances]
        assert names == [effect["effect"] for effect in effects]
        if effects:
            cause = causes_of(continuation.problems[selection.stage], selection.winner)[0]
            number = cause.parameters["scale"]
            assert abs(number.value - 1.6) < 4.0 * number.standard_error
        assert with_noise.gaps == found.gaps
        assert with_noise.gauss_markov is not None
        assert with_noise.gauss_markov[0, 0] == pytest.approx(0.3, rel=0.7)


@pytest.mark.parametrize(("effects", "size"), [([], 0.3), (["yaw_damping"], 0.06)])
def test_no_second_effect_is_tried_under_white_noise_where_position_noise_suffices(
    effects: list[str], size: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = simulated_runs([{"effect": name, "scale": 1.6} for name in effects], seed=12)
    errors = gauss_markov_noise(np.random.default_rng(2), (3, found.measured.shape[1], 2), size, 20.0)
    found.measured[..., :2] += errors
    names = ("external_force", "mass", "yaw_damping")
    possible = [one for one in candidates(found.boat, SECONDS) if one.effect.name in names and not one.groups]
    searches = list[Selection]()

    def recorded(*given: Any) -> Selection:
        searches.append(beam_search(*given))
        return searches[-1]

    monkeypatch.setattr(model_selection, "beam_search", recorded)
    with_noise, _, selection = select_model(found, weights(found, noise_levels(found)), possible, None)
    assert with_noise.gauss_markov is not None
    assert [one.label for one in selection.winner.hypothesis.instances] == effects
    assert {len(one.hypothesis.instances) for one in searches[0].tried} == {1}


def test_clean_data_need_no_position_noise() -> None:
    found = simulated_runs([], seed=3)
    weight = weights(found, noise_levels(found))
    with_noise, _, selection = select_model(found, weight, candidates(found.boat, SECONDS)[:3], None)
    assert selection.winner.hypothesis == Hypothesis()
    assert with_noise.gauss_markov is None
