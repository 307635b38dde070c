"""Model selection goes on from what a search of another kind has found."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.backward_elimination import fit_by_continuation
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from swamp_rl.criticism.selection.model_selection import (
    best_on_whole_runs,
    likeliest_beside_position_noise,
    select_model,
    slowest_noise,
)
from tests.support.criticism import DT, SECONDS, driven, gauss_markov_noise, simulated_runs

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


def runs_of_a_slow_wandering_log(offset: float, seed: int) -> RunSet:
    """Three runs of 100 s, logged at 2 Hz without velocities, commands held for 1.5 to 6 s from instants
    between the rows; positions wander, and the receiver's clock is off by `offset` [s].
    """
    rng = np.random.default_rng(seed)
    commands = np.zeros((3, 1000, 8))
    for run in commands:
        begin = 0
        while begin < len(run):
            azimuth, throttle, apart = rng.uniform(-0.4, 0.4), rng.uniform(0.5, 0.8), rng.uniform(-0.2, 0.2)
            run[begin:, :4] = azimuth * np.array([1, 1, -1, -1])
            run[begin:, 4:] = throttle + apart * np.array([1, -1, 1, -1])
            begin += int(rng.integers(15, 60))
    made = driven([{"effect": "clock_offset", "offset": offset}], commands, 0.8, seed)
    measured = made.measured + [0.3, 0.3, 0.02, 0.0, 0.0, 0.0] * rng.standard_normal(made.measured.shape)
    measured[..., :2] += gauss_markov_noise(rng, measured[..., :2].shape, 0.5, 50.0)
    measured[..., 3:] = np.nan
    every = round(0.5 / DT)
    rows = commands[:, ::every].copy(), measured[:, ::every].copy()
    return replace(made, dt=0.5, commands=rows[0], measured=rows[1], lengths=np.full(3, rows[0].shape[1]))


def test_a_clock_that_is_off_is_not_taken_for_commands_between_rows_and_position_noise() -> None:
    made = runs_of_a_slow_wandering_log(-0.55, seed=1)
    continuation = continuation_of(made, weights(made, noise_levels(made)))
    offset = Hypothesis((by_label(candidates(made.boat, SECONDS))["clock_offset"],))
    fitted = fit_by_continuation(continuation, offset, np.array([-0.5]))
    found = likeliest_beside_position_noise(continuation, fitted, slowest_noise(continuation, fitted))
    assert found is not None and found.hypothesis.label == "clock_offset"
