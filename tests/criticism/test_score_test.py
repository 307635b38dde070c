"""Score tests: the expected fall of chi2 by each effect, without a fit."""

from dataclasses import replace
from typing import Any

import numba
import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood import multiple_shooting
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model import rollout
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.criticism.selection.score_test import score_tests, score_tests_from_neutral
from tests.support.criticism import SECONDS, simulated_runs

FAILURE = "thruster_failure bp"


@pytest.mark.parametrize("boat", ["swamp", "swamp-light"])
def test_a_thruster_that_failed_early_comes_first_and_near_its_fit(boat: str) -> None:
    """The boat file alone is far from the data, its fitted states are bent for want of the failure."""
    failed = {"effect": "thruster_failure", "thruster": "bp", "time": 5.0}
    runs = simulated_runs([failed], velocities=False, name=boat)
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    every = by_label(candidates(runs.boat, SECONDS))
    problem = continuation.problems[0]
    first, *_ = score_tests(problem, continuation.boat_file(0), list(every.values()))
    assert first.instance.label == FAILURE
    made = fit(problem, first.hypothesis, first.x, first.states)
    np.testing.assert_allclose(made.x, [5.0], atol=0.1)
    assert first.expected_chi2 < 1.5 * made.chi2


def test_a_swap_is_scored_from_the_measured_states_where_those_of_the_fit_diverge() -> None:
    found = simulated_runs([{"effect": "channel_swap", "thruster": ["bs", "sp"]}])
    problem = continuation_of(found, weights(found, noise_levels(found))).problems[0]
    nothing = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), 1)
    assert nothing.chi2 > 10.0 * problem.samples
    turning = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1e5])  # rad/s
    bent = replace(nothing, states=nothing.states + turning)
    (score,) = score_tests(problem, bent, [by_label(candidates(found.boat, SECONDS))["channel_swap bs sp"]])
    assert score.expected_chi2 < 2.0 * problem.samples


def boat_file_alone() -> tuple[RunSet, Shooting, Fit]:
    """Runs of a boat with no effect, their shortest windows, and the fit of the boat file to these."""
    runs = simulated_runs([])
    problem = continuation_of(runs, weights(runs, noise_levels(runs))).problems[0]
    return runs, problem, fit(problem, Hypothesis(), np.zeros(0), problem.initial_states())


def test_score_tests_that_are_asked_for_again_are_not_simulated_again_and_count_as_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    runs, problem, at = boat_file_alone()
    every = candidates(runs.boat, SECONDS)
    before = problem.boat_steps[0]
    first = score_tests(problem, at, every)
    steps = problem.boat_steps[0] - before
    score_tests(problem, at, every[:2])
    simulated = list[int]()

    def counted(*given: Any) -> None:
        simulated.append(len(given[-1]))
        rollout.roll(*given)

    monkeypatch.setattr(multiple_shooting, "roll", counted)
    before = problem.boat_steps[0]
    again = score_tests(problem, at, list(every))
    assert [one is other for one, other in zip(first, again, strict=True)] == [True] * len(first)
    assert not simulated and problem.boat_steps[0] - before == steps
    other = score_tests(problem, replace(at, states=at.states + 0.01), every)
    assert simulated and other[0].expected_chi2 != first[0].expected_chi2
    slower = problem.with_commands(replace(runs, commands=0.5 * runs.commands))
    assert score_tests(slower, at, every)[0].expected_chi2 != first[0].expected_chi2


def test_score_tests_in_several_threads_are_those_of_one_and_count_as_many_steps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    runs, problem, at = boat_file_alone()
    every = candidates(runs.boat, SECONDS)
    found = []
    for threads in (1, 3):
        monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", threads)
        before = problem.boat_steps[0]
        scores = [(one.instance.label, one.expected_chi2) for one in score_tests(problem, replace(at), every)]
        found.append((scores, problem.boat_steps[0] - before))
    assert found[0] == found[1]


def test_score_tests_of_other_starts_and_fewer_effects_simulate_nothing_that_was_simulated_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    runs, problem, at = boat_file_alone()
    every = [one for one in candidates(runs.boat, SECONDS) if one.size and one.effect.begin == "score"]
    anew = replace(at)
    before = problem.boat_steps[0]
    expected = score_tests_from_neutral(problem, anew, every[5:])
    steps = problem.boat_steps[0] - before
    score_tests(problem, at, every)
    monkeypatch.setattr(multiple_shooting, "roll", None)
    before = problem.boat_steps[0]
    found = score_tests_from_neutral(problem, at, every[5:])
    assert problem.boat_steps[0] - before == steps
    for one, other in zip(found, expected, strict=True):
        assert one.hypothesis == other.hypothesis and one.instance == other.instance
        assert (one.expected_chi2, one.information) == (other.expected_chi2, other.information)
