"""Fits to short windows begin those to longer ones, and none is worse than what it contains."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


@pytest.mark.parametrize("effect, far", [("external_force", [30.0, 30.0]), ("command_delay", [3.0])])
def test_a_fit_that_is_worse_than_the_boat_file_begins_again_at_its_neutral_values(
    effect: str, far: list[float]
) -> None:
    runs = simulated_runs([])
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))[effect],))
    with using(stage_steps=(1, 1, 1, 1), steps_when_close=1):  # too few for the way from there
        continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
        nothing = continuation.boat_file(MIDDLE)
        made = continuation.fit(MIDDLE, hypothesis, np.array(far))
    assert made.chi2 < nothing.chi2 + 50.0


@pytest.mark.parametrize(("thruster", "time"), [("sp", 12.3), ("sp", 21.6), ("bs", 21.6)])
@pytest.mark.parametrize("away", [-4.0, -2.5, 2.5, 4.0])
def test_the_instant_of_a_failure_is_found_from_seconds_away(thruster: str, time: float, away: float) -> None:
    """From a plain receiver, without velocities."""
    failed = {"effect": "thruster_failure", "thruster": thruster, "time": time}
    runs, rng = simulated_runs([failed], velocities=False), np.random.default_rng(0)
    noise = rng.standard_normal(runs.measured.shape) * [0.5, 0.5, 0.015, 0.0, 0.0, 0.0]
    runs = replace(runs, measured=runs.measured + noise)
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))[f"thruster_failure {thruster}"],))
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    made = continuation.fit(0, hypothesis, np.array([time + away]))
    assert made.x[0] == pytest.approx(time, abs=0.15)


def test_a_search_tries_single_effects_however_much_the_boat_file_took_unless_it_is_to_try_none() -> None:
    runs = simulated_runs([{"effect": "resistance", "scale": 1.5}])
    weight = weights(runs, noise_levels(runs))
    every = [one for one in candidates(runs.boat, SECONDS) if one.label in ("resistance", "yaw_damping")]
    for budget, found in ((1.0, "resistance"), (0.0, "nothing")):
        continuation = continuation_of(runs, weight)
        assert beam_search(continuation, every, None, budget).winner.hypothesis.label == found
