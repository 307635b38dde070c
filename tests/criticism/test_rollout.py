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
