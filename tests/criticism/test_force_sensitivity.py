"""Normal equations of short forces, in chunks of bounded memory."""

import tracemalloc

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.finite_differences import state_jacobian
from swamp_rl.criticism.likelihood.force_sensitivity import force_grid, force_jacobian, force_normal_equations
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import using
from tests.support.criticism import simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

AXES = (0, 1, 2)


def test_chunks_give_the_equations_of_all_windows_in_less_memory() -> None:
    found = simulated_runs([])
    problem = Shooting(found, weights(found, noise_levels(found)), 5.0)
    states, nothing, at_rest = problem.initial_states(), Hypothesis(), np.zeros(0)
    base = problem.predict(nothing, at_rest[None], states[None])[0]
    residual = problem.residuals(base)
    by_state = state_jacobian(problem, nothing, at_rest, states, base)
    pieces = force_grid(problem, 0.5)
    where = (problem, nothing, at_rest, states, pieces, AXES)
    force_normal_equations(*where, by_state, residual)  # compiled

    tracemalloc.start()
    slopes = force_jacobian(*where)
    whole = normal_equations(by_state, slopes, residual)
    at_once = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    del slopes
    tracemalloc.start()
    with using(chunk_bytes=2**18):
        parts = force_normal_equations(*where, by_state, residual)
    in_chunks = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()

    assert in_chunks < 0.4 * at_once
    assert parts.information == pytest.approx(whole.information, rel=1e-9, abs=1e-12)
    assert parts.gradient == pytest.approx(whole.gradient, rel=1e-9, abs=1e-9)
    assert parts.profile_chi2 == pytest.approx(whole.profile_chi2)
