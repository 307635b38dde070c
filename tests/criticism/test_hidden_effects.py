"""Effects below the model's own error, distinguished from those that the data cannot show."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.identifiability import hidden_effects
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, by_label, candidates
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.score_test import score_tests
from tests.support.criticism import SECONDS, simulated_runs

NONE = np.zeros(0)
RUNS = simulated_runs([])
WEIGHT = weights(RUNS, noise_levels(RUNS))
SOME = ("mass", "resistance", "heading_bias", "hull_asymmetry", "shallow_water")


@pytest.fixture(scope="module")
def problem() -> Shooting:
    return Shooting(RUNS, WEIGHT, 5.0)


@pytest.fixture(scope="module")
def nothing(problem: Shooting) -> Fit:
    return fit(problem, Hypothesis(), NONE, problem.initial_states(), 4)


def instances() -> list[EffectInstance]:
    return [by_label(candidates(RUNS.boat, SECONDS))[name] for name in SOME]


def test_under_a_larger_model_error_more_effects_are_hidden(problem: Shooting, nothing: Fit) -> None:
    first = score_tests(problem, nothing, instances())
    shown = {
        one.instance.label: one.information for one in first if one.information >= options().least_information
    }
    assert len(shown) >= 4
    before: set[str] = set()
    for times in (3.0, 30.0, 3000.0):
        off = replace(nothing, residual=times * nothing.residual, loss=times**2 * nothing.loss)
        found = Selection(off, False, 1, [], [], first, [])
        hidden = set(hidden_effects(RUNS, WEIGHT, problem, found, instances()))
        assert before <= hidden <= set(shown)
        assert all(shown[label] < options().least_information * times**2 * 3.0 for label in hidden)
        assert all(
            shown[label] > options().least_information * times**2 * 0.3 for label in set(shown) - hidden
        )
        before = hidden
    assert before == set(shown)
    adequate = Selection(off, True, 1, [], [], first, [])
    assert hidden_effects(RUNS, WEIGHT, problem, adequate, instances()) == []


def test_what_only_weights_by_the_model_error_hide_is_distinguished_from_what_the_data_cannot_show(
    problem: Shooting, nothing: Fit
) -> None:
    weighted = Shooting(RUNS, WEIGHT / 1e4, 20.0)
    weighted.correlation_samples = 20.0
    every = instances()
    found = Selection(nothing, False, 0, [], [], [], [one.label for one in every])
    hidden = hidden_effects(RUNS, WEIGHT, weighted, found, every)
    first = score_tests(problem, nothing, every)
    assert set(hidden) == {
        one.instance.label for one in first if one.information >= options().least_information
    }
    faint = hidden_effects(RUNS, WEIGHT / 1e4, weighted, found, every)
    assert faint == []
