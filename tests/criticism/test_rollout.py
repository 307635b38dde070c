"""Simulation of many windows: divided among threads, the same bits."""

import numba
import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.options import using
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
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    with using(thread_steps=1):
        divided = problem.predict(Hypothesis((instance,)), x, np.repeat(states[None], len(x), axis=0))
    assert np.isfinite(alone).all()
    np.testing.assert_array_equal(divided, alone)


@pytest.mark.parametrize("effect", ["wind", "current", "azimuth_lag", "position_delay"])
def test_variants_side_by_side_are_simulated_to_the_bits_of_each_alone(effect: str) -> None:
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    (instance,) = [one for one in candidates(runs.boat, SECONDS) if one.label == effect]
    x, states = np.array([0.4] * instance.size), problem.initial_states()
    started = np.stack([states, states + 0.1, states - 0.2])
    together = problem.predict(Hypothesis((instance,)), np.repeat(x[None], 3, axis=0), started)
    for seen, start in zip(together, started, strict=True):
        np.testing.assert_array_equal(seen, problem.track(Hypothesis((instance,)), x, start))


def test_a_jacobian_that_was_kept_is_that_of_its_windows() -> None:
    runs = simulated_runs([])
    problem, nothing, x = Shooting(runs, weights(runs, noise_levels(runs)), 5.0), Hypothesis(), np.zeros(0)
    states = problem.initial_states()
    moved = states + 0.1 * (np.arange(len(states)) % 2)[:, None]
    first, second = (
        problem.state_jacobian(nothing, x, one, problem.track(nothing, x, one)) for one in (states, moved)
    )
    problem.last_slopes.clear()
    anew = problem.state_jacobian(nothing, x, moved, problem.track(nothing, x, moved))
    np.testing.assert_array_equal(second, anew)
    np.testing.assert_array_equal(second[::2], first[::2])
    assert (second[1::2] != first[1::2]).any()
