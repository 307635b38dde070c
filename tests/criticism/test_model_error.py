"""Model error above the measurement noise: its size, its correlation time, and effects selected under it."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.cross_validation import Confirmation
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.nuisance.curve_errors import Marginal
from swamp_rl.criticism.nuisance.process_noise import correlation_samples, in_noise_units, model_error
from swamp_rl.criticism.selection import stepwise_selection
from swamp_rl.criticism.selection.stepwise_selection import (
    RatioTests,
    best_confirmed,
    most_likely,
    select_under_model_error,
    single_stage,
    without_dispensable,
)
from tests.support.criticism import SECONDS, gauss_markov_noise, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

CONFIRMED = Confirmation(gain=30.0, low=10.0, level=0.999)


def test_an_error_lasts_as_long_as_its_autocorrelation_says() -> None:
    rng = np.random.default_rng(0)
    errors = np.stack([gauss_markov_noise(rng, (200, 400, 1), 1.0, 1.0)[..., 0]] * 6, axis=2)
    keep = np.exp(-0.1)
    assert correlation_samples(errors) == pytest.approx((1.0 + keep) / (1.0 - keep), rel=0.15)
    assert correlation_samples(rng.standard_normal((200, 400, 6))) == pytest.approx(1.0, abs=0.1)
    assert correlation_samples(np.zeros((2, 40, 6))) == 1.0


def test_a_steady_wind_is_selected_under_gusts(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO", logger="swamp_rl.criticism")
    found = simulated_runs(
        [
            {"effect": "wind", "speed": 6.0, "from": 1.0},
            {"effect": "gusts", "speed_std": 1.5, "direction_std": 0.3, "time_constant": 8.0},
        ]
    )
    weight = weights(found, noise_levels(found))
    instances = [
        instance
        for instance in candidates(found.boat, SECONDS)
        if instance.effect.name in ("wind", "mass", "position_delay")
    ]
    result = select_under_model_error(found, weight, instances, None)
    slow, selection = result[0].gauss_markov, result[2]
    assert slow is not None and (slow[:2, 0] > 1.5 / weight.max(axis=(0, 1))[:2]).all()
    assert selection.winner.hypothesis.label == "wind"
    assert np.hypot(*selection.winner.x) == pytest.approx(6.0, rel=0.25)
    assert np.arctan2(*selection.winner.x[::-1]) == pytest.approx(1.0, abs=0.25)
    assert selection.confirmed["wind"].holds and not selection.adequate
    assert "selection under model error" in caplog.text
    labels = [one.hypothesis.label for one in selection.tried]
    assert len(set(labels)) == len(labels), "a set of effects is listed twice"


def test_sets_of_effects_are_compared_without_what_held_out_windows_do_not_confirm() -> None:
    found = simulated_runs(
        [{"effect": "wind", "speed": 6.0, "from": 1.0}, {"effect": "resistance", "scale": 1.6}]
    )
    weight = weights(found, noise_levels(found))
    continuation = single_stage(model_error(found, weight, Hypothesis(), np.zeros(0), 10.0))
    known, states = by_label(candidates(found.boat, SECONDS)), continuation.problems[0].initial_states()
    starts = {"wind": (3.0, 4.0), "resistance": (1.2,), "position_delay": (0.1,)}

    def fitted(*names: str) -> Fit:
        hypothesis = Hypothesis(tuple(known[name] for name in sorted(names)))
        return continuation.fit(
            0, hypothesis, np.array([x for n in sorted(names) for x in starts[n]]), states
        )

    fits = [fitted("wind"), fitted("resistance"), fitted("wind", "resistance", "position_delay")]
    best, confirmed = best_confirmed(continuation, fits, RatioTests(found, weight, 3))
    assert best.hypothesis.label == "resistance + wind"
    assert all(one.holds for one in confirmed.values())


def test_of_effects_that_held_out_windows_do_not_separate_the_more_likely_is_selected() -> None:
    found = simulated_runs([{"effect": "position_delay", "delay": 0.4}], velocities=False)
    weight = weights(found, noise_levels(found))
    continuation = single_stage(model_error(found, weight, Hypothesis(), np.zeros(0), 10.0))
    known, states = by_label(candidates(found.boat, SECONDS)), continuation.problems[0].initial_states()
    names = ("position_delay", "clock_offset")
    fits = [continuation.fit(0, Hypothesis((known[n],)), np.array([0.3]), states) for n in names]
    for likely in fits:
        tests = RatioTests(found, weight, 3)
        for one in fits:
            at = tests.marginal(one)
            worse = replace(at, deviance=at.deviance + 20.0 * (one is not likely))
            tests.marginals[one.hypothesis.label, one.x.tobytes()] = worse
        best, confirmed = most_likely(continuation, *best_confirmed(continuation, fits, tests), fits, tests)
        assert best is likely and all(one.holds for one in confirmed.values())


def test_a_likelier_effect_that_held_out_windows_do_not_confirm_leaves_the_best_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = simulated_runs([{"effect": "position_delay", "delay": 0.4}], velocities=False)
    weight = weights(found, noise_levels(found))
    continuation = single_stage(model_error(found, weight, Hypothesis(), np.zeros(0), 10.0))
    known, states = by_label(candidates(found.boat, SECONDS)), continuation.problems[0].initial_states()
    names = ("clock_offset", "position_delay", "command_delay")
    likeliest, best, other = (
        continuation.fit(0, Hypothesis((known[n],)), np.array([0.3]), states) for n in names
    )
    tests = RatioTests(found, weight, 3)
    for one, deviance in ((likeliest, 0.0), (other, 10.0), (best, 20.0)):
        tests.marginals[one.hypothesis.label, one.x.tobytes()] = Marginal(deviance, np.zeros(4), np.zeros(0))

    def as_said(problem: Shooting, whole: Fit, less: Fit, comparisons: int) -> Confirmation:
        alone = not less.hypothesis.instances  # no two effects are separated, and one is not confirmed
        return replace(CONFIRMED, low=1.0 if alone and whole is not likeliest else -1.0)

    monkeypatch.setattr(stepwise_selection, "confirmation", as_said)
    kept, _ = most_likely(continuation, best, {"position_delay": CONFIRMED}, [likeliest, best, other], tests)
    assert kept is best


@pytest.mark.parametrize(("gain", "label"), [(1.1, "position_delay"), (0.9, "nothing")])
def test_an_effect_of_less_likelihood_than_its_parameters_cost_is_left_out(gain: float, label: str) -> None:
    found = simulated_runs([{"effect": "position_delay", "delay": 0.4}], velocities=False)
    weight = weights(found, noise_levels(found))
    continuation = single_stage(model_error(found, weight, Hypothesis(), np.zeros(0), 10.0))
    whole = Hypothesis((by_label(candidates(found.boat, SECONDS))["position_delay"],))
    best = continuation.fit(0, whole, np.array([0.3]), continuation.problems[0].initial_states())
    tests = RatioTests(found, weight, 3)
    cost = continuation.criterion.charge(whole) - continuation.criterion.charge(Hypothesis())
    for key, deviance in (((whole.label, best.x.tobytes()), -gain * cost), (("nothing", b""), 0.0)):
        tests.marginals[key] = Marginal(deviance, np.zeros(4), np.zeros(0))
    kept, _ = without_dispensable(continuation, best, {whole.label: CONFIRMED}, tests)
    assert kept.hypothesis.label == label


def test_adequacy_is_tested_against_the_measurement_noise_not_the_model_error() -> None:
    found = simulated_runs([{"effect": "external_force", "north": 3.0, "east": -2.0}])
    weight = weights(found, noise_levels(found))
    weighted = model_error(found, weight, Hypothesis(), np.zeros(0))
    assert adequacy(weighted.problem, weighted.fit).adequate
    assert not adequacy(weighted.problem, in_noise_units(weighted.fit, weighted.problem, weight)).adequate


def test_channels_that_were_not_measured_have_no_error() -> None:
    found = simulated_runs([{"effect": "external_force", "north": 3.0, "east": -2.0}], velocities=False)
    weighted = model_error(found, weights(found, noise_levels(found)), Hypothesis(), np.zeros(0))
    assert (weighted.errors[3:5, 0] == 0.0).all() and (weighted.errors[[0, 1, 2, 5], 0] > 0.0).all()
    assert np.isfinite(weighted.fit.chi2)
    assert (
        weighted.run_set.gauss_markov is not None
        and replace(weighted.run_set, gauss_markov=None).gauss_markov is None
    )
