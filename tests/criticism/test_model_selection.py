"""Model selection goes on from what a search of another kind has found."""

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from swamp_rl.criticism.selection.model_selection import best_on_whole_runs, select_model
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_what_is_found_under_model_error_and_leaves_noise_is_a_cause() -> None:
    made = simulated_runs([{"effect": "mass", "mass": 64.0}], seed=21)
    names = ("mass", "thrust_scale", "yaw_damping")
    instances = [one for one in candidates(made.boat, SECONDS) if one.effect.name in names]
    with using(step_budget=0.0):  # no search under white noise
        _, _, found = select_model(made, weights(made, noise_levels(made)), instances, None)
    assert found.adequate and found.winner.hypothesis.label == "mass"
    assert found.winner.x == pytest.approx([64.0], abs=0.5)


def test_of_the_hypotheses_fitted_to_whole_runs_the_best_is_known() -> None:
    made = simulated_runs([{"effect": "mass", "mass": 64.0}], seed=21)
    continuation = continuation_of(made, weights(made, noise_levels(made)))
    known = by_label(candidates(made.boat, SECONDS))
    starts = {"mass": 64.0, "thrust_scale": 0.9}
    fits = {
        name: continuation.fit(MIDDLE, Hypothesis((known[name],)), np.array([start]))
        for name, start in starts.items()
    }
    assert best_on_whole_runs(continuation, fits["thrust_scale"]).hypothesis.label == "thrust_scale"
    assert best_on_whole_runs(continuation, fits["mass"]).hypothesis.label == "mass"
    assert best_on_whole_runs(continuation, fits["thrust_scale"]).hypothesis.label == "mass"
