"""Simulation of many windows: divided among threads, the same bits."""

from contextvars import copy_context
from typing import Any
from unittest.mock import MagicMock

import numba
import numpy as np
import pytest

from swamp_rl.criticism import threads
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood import multiple_shooting
from swamp_rl.criticism.likelihood.finite_differences import state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Iterate, jacobians_at
from swamp_rl.criticism.model import rollout
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates, differing
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.score_test import neutral_start
from tests.support.criticism import SECONDS, simulated_runs


@pytest.mark.parametrize("effect", ["mass", "azimuth_lag"])
def test_windows_divided_among_threads_are_simulated_to_the_same_bits(
    effect: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    instance = by_label(candidates(runs.boat, SECONDS))[effect]
    x, states = np.array(instance.starts), problem.initial_states()
    alone = problem.predict(Hypothesis((instance,)), x, np.repeat(states[None], len(x), axis=0))
    problem.histories.clear()
    problem.tracks = {}
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    with using(thread_steps=1):
        divided = problem.predict(Hypothesis((instance,)), x, np.repeat(states[None], len(x), axis=0))
    assert np.isfinite(alone).all()
    np.testing.assert_array_equal(divided, alone)


def test_jacobians_divided_among_threads_have_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    known = by_label(candidates(runs.boat, SECONDS))
    windy = differing(known["wind"], "run", tuple(range(len(runs.lengths))))
    hypothesis, states = Hypothesis((known["mass"], windy)), problem.initial_states()
    x = np.full(hypothesis.size, 0.9)

    def made() -> list[np.ndarray]:
        at = Iterate(x, states, problem.track(hypothesis, x, states), np.zeros((0, 0)), 0.0)
        normal = jacobians_at(problem, hypothesis, at).normal(problem.residuals(at.base))
        return [normal.cross, normal.information, normal.gradient, normal.profile_chi2]

    alone = made()
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    begun = MagicMock(side_effect=copy_context)
    monkeypatch.setattr(threads, "copy_context", begun)
    with using(thread_steps=1, slope_share=1):
        divided = made()
    # two beside the caller's own, for slopes, products and normal equations
    assert begun.call_count == 2 * 3 and np.isfinite(alone[1]).all()
    for one, other in zip(divided, alone, strict=True):
        np.testing.assert_array_equal(one, other)


def test_one_run_and_several_are_simulated_by_the_same_compiled_function() -> None:
    runs = simulated_runs([])
    for some in (runs.subset([0]), runs):
        problem = Shooting(some, weights(some, noise_levels(some)), 5.0)
        problem.track(Hypothesis(), np.zeros(0), problem.initial_states())
    assert rollout._roll.signatures and all(records.mutable for records, *_ in rollout._roll.signatures)


@pytest.mark.parametrize("effect", ["wind", "current", "azimuth_lag", "position_delay"])
def test_variants_side_by_side_are_simulated_to_the_bits_of_each_alone(effect: str) -> None:
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    (instance,) = [one for one in candidates(runs.boat, SECONDS) if one.label == effect]
    x, states = np.array([0.4] * instance.size), problem.initial_states()
    started = np.stack([states, states + 0.1, states - 0.2])
    together = problem.predict(Hypothesis((instance,)), np.repeat(x[None], 3, axis=0), started)
    for seen, start in zip(together, started, strict=True):
        problem.tracks = {}
        np.testing.assert_array_equal(seen, problem.track(Hypothesis((instance,)), x, start))


@pytest.mark.parametrize("effect", ["mass", "azimuth_lag", "position_delay", "clock_offset"])
def test_a_track_that_was_kept_is_the_one_that_is_simulated_anew(effect: str) -> None:
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    (instance,) = [one for one in candidates(runs.boat, SECONDS) if one.label == effect]
    hypothesis, states = Hypothesis((instance,)), problem.initial_states()
    x = np.array(neutral_start(instance, runs.boat)) + np.array([[0.0], [0.1]]) * instance.scales
    plain = problem.track(Hypothesis(), np.zeros(0), states)
    part = problem.part(np.arange(len(states)) % 2 == 0)
    kept = [problem.predict(hypothesis, x[:1], states[None]), part.track(hypothesis, x[0], states[::2])]
    kept.append(problem.predict(hypothesis, x, np.repeat(states[None], 2, axis=0)))
    with using(most_tracks=0):
        problem.track(hypothesis, x[0], states)
        anew = [problem.predict(hypothesis, x[:1], states[None]), part.track(hypothesis, x[0], states[::2])]
        anew.append(problem.predict(hypothesis, x, np.repeat(states[None], 2, axis=0)))
    for one, other in zip(kept, anew, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(kept[0][0], plain)
    assert (kept[2][1] != plain).any()


def test_only_tracks_not_kept_are_simulated_and_every_one_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = simulated_runs([])
    problem, nothing, x = (
        Shooting(runs, weights(runs, noise_levels(runs)), 5.0),
        Hypothesis(),
        np.zeros((2, 0)),
    )
    simulated = list[int]()

    def counted(*given: Any) -> None:
        simulated.append(len(given[-1]) // problem.windows.count)
        rollout.roll(*given)

    monkeypatch.setattr(multiple_shooting, "roll", counted)
    states = problem.initial_states()
    first = problem.track(nothing, x[0], states)
    steps = problem.boat_steps[0]
    first[:] = 0.0  # what was given away may be changed
    both = problem.predict(nothing, x, np.stack([states, states + 0.1]))
    assert (both[0] != 0.0).any() and simulated == [1, 1] and problem.boat_steps[0] == 3 * steps
    problem.substeps *= 2
    assert (problem.track(nothing, x[0], states) != both[0]).any() and simulated == [1, 1, 1]


def test_a_jacobian_that_was_kept_is_that_of_its_windows() -> None:
    runs = simulated_runs([])
    problem, nothing, x = Shooting(runs, weights(runs, noise_levels(runs)), 5.0), Hypothesis(), np.zeros(0)
    states = problem.initial_states()
    moved = states + 0.1 * (np.arange(len(states)) % 2)[:, None]
    first, second = (
        state_jacobian(problem, nothing, x, one, problem.track(nothing, x, one)) for one in (states, moved)
    )
    problem.last_slopes.clear()
    anew = state_jacobian(problem, nothing, x, moved, problem.track(nothing, x, moved))
    np.testing.assert_array_equal(second, anew)
    np.testing.assert_array_equal(second[::2], first[::2])
    assert (second[1::2] != first[1::2]).any()
