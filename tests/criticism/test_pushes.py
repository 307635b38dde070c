"""Normal equations of short forces, in chunks of bounded memory."""

import tracemalloc

import numpy as np
import pytest

from swamp_rl.criticism import pushes
from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.fit import normal_equations
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.pushes import push_normal, push_slopes, pushes_of
from swamp_rl.criticism.shooting import Shooting
from tests.support.criticism import trials

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

AXES = (0, 1, 2)


def test_chunks_give_the_equations_of_all_windows_in_less_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    found = trials([])
    problem = Shooting(found, weights(found, noise_levels(found)), 5.0)
    states, nothing, at_rest = problem.guess(), Hypothesis(), np.zeros(0)
    base = problem.predict(nothing, at_rest[None], states[None])[0]
    residual = problem.residuals(base)
    by_state = problem.state_jacobian(nothing, at_rest, states, base)
    pieces = pushes_of(problem, 0.5)
    where = (problem, nothing, at_rest, states, pieces, AXES)
    push_normal(*where, by_state, residual)  # compiled

    tracemalloc.start()
    slopes = push_slopes(*where)
    whole = normal_equations(by_state, slopes, residual)
    at_once = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    del slopes
    monkeypatch.setattr(pushes, "CHUNK", 2**18)
    tracemalloc.start()
    parts = push_normal(*where, by_state, residual)
    in_chunks = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()

    assert in_chunks < 0.4 * at_once
    assert parts.information == pytest.approx(whole.information, rel=1e-9, abs=1e-12)
    assert parts.gradient == pytest.approx(whole.gradient, rel=1e-9, abs=1e-9)
    assert parts.free == pytest.approx(whole.free)
