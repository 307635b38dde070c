"""Effects that are too small for short windows, and effects whose first start diverges."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.cross_validation import stretch_losses
from swamp_rl.criticism.model.candidates import (
    EffectInstance,
    Hypothesis,
    by_label,
    candidates,
    hull_nuisance,
)
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.backward_elimination import confirmed_on, fit_by_continuation
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation, continuation_of
from swamp_rl.criticism.selection.score_test import at_neutral_values, score_tests
from swamp_rl.criticism.selection.small_effects import is_small, with_slow_effects, with_small_effects
from swamp_rl.simulator import parameters
from tests.support.criticism import SECONDS, gauss_markov_noise, select_effects, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

UNSTABLE = "swamp-thesis"  # whose unbroken runs show what short windows do not
BOAT = load_boat(UNSTABLE)
INSTANCES = [*candidates(BOAT, SECONDS), *filter(None, [hull_nuisance(BOAT)])]
SMALL = [
    {"effect": "current", "north": 0.0015, "east": -0.001},
    {"effect": "mass", "mass": 58.12},
    {"effect": "thrust_scale", "scale": 0.9978},
]


def continued(found: RunSet) -> Continuation:
    return continuation_of(found, weights(found, noise_levels(found)))


@pytest.mark.parametrize(
    "instance",
    [one for one in INSTANCES if is_small(one) and one.effect.name != "waves"],
    ids=lambda one: one.label,
)
def test_neutral_values_leave_the_boat_file_unchanged(instance: EffectInstance) -> None:
    plain = parameters(BOAT)[0]
    softly = Hypothesis((at_neutral_values(instance, BOAT),))
    record = softly.records(BOAT, np.array(softly.instances[0].starts))[0]
    moved = {name for name in plain.dtype.names if not np.allclose(record[name], plain[name], atol=0.005)}
    assert moved <= {"wind_from"}


def test_a_cause_is_added_that_windows_of_twenty_seconds_show() -> None:
    made = simulated_runs([{"effect": "mass", "mass": 64.0}], seed=21)
    continuation = continued(made)
    nothing = fit_by_continuation(continuation, Hypothesis(), np.zeros(0))
    every = candidates(made.boat, SECONDS)
    found = with_slow_effects(continuation, nothing, every)
    assert found.hypothesis.label == "mass" and found.x[0] == pytest.approx(64.0, abs=0.5)
    assert with_slow_effects(continuation, found, every).hypothesis == found.hypothesis


def in_shallow_water(depth_over_draught: float, position: float, heading: float, seed: int) -> Continuation:
    """Runs of positions with slow noise of 0.5 m and white noise of `position` [m], and headings [rad]."""
    made = simulated_runs([{"effect": "shallow_water", "depth_over_draught": depth_over_draught}], seed)
    rng = np.random.default_rng(seed)
    measured, shape = made.measured.copy(), made.measured.shape[:2]
    measured[..., :2] += position * rng.standard_normal((*shape, 2))
    measured[..., :2] += gauss_markov_noise(rng, (*shape, 2), 0.5, 60.0)
    measured[..., 2] += heading * rng.standard_normal(shape)
    measured[..., 3:] = np.nan
    slow = np.where(np.arange(6)[:, None] < 2, [0.5, 60.0, 1.0], [0.0, 0.0, 1.0])
    return continued(replace(made, measured=measured, gauss_markov=slow))


def test_effects_are_compared_on_windows_that_show_more_than_noise() -> None:
    continuation = in_shallow_water(3.5, 0.3, 0.04, seed=2)
    every = [one for one in candidates(continuation.run_set.boat, SECONDS) if not one.groups]
    short, nothing = continuation.problems[0], continuation.boat_file(0)
    assert continuation.is_adequate(0, nothing)
    assert score_tests(short, nothing, every)[0].instance.label != "shallow_water"
    found = beam_search(continuation, every, None)
    assert found.first[0].instance.label == found.winner.hypothesis.label == "shallow_water"


def test_an_effect_without_a_derivative_at_its_neutral_value_is_found_on_whole_runs() -> None:
    continuation = in_shallow_water(3.0, 0.3, 0.06, seed=0)
    assert continuation.is_adequate(MIDDLE, continuation.boat_file(MIDDLE))
    names = ("shallow_water", "mass", "resistance", "yaw_inertia", "thrust_scale", "yaw_damping")
    every = [one for one in candidates(continuation.run_set.boat, SECONDS) if one.label in names]
    found = beam_search(continuation, every, None)
    assert found.winner.hypothesis.label == "shallow_water"
    assert found.winner.x[0] == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("effect", SMALL, ids=lambda one: one["effect"])
def test_a_cause_that_windows_of_twenty_seconds_do_not_show_is_found(effect: dict[str, object]) -> None:
    made = simulated_runs([effect], seed=21, name=UNSTABLE)
    continuation, instance = continued(made), by_label(INSTANCES)[str(effect["effect"])]
    nothing = fit_by_continuation(continuation, Hypothesis(), np.zeros(0))
    at = fit_by_continuation(continuation, Hypothesis((instance,)), np.array(instance.starts[0]))
    assert nothing.chi2 - at.chi2 < continuation.criterion.required_gain(Hypothesis(), instance)
    found = select_effects(made)
    assert found.adequate
    assert instance.label in [one.hypothesis.cause_label for one in (found.winner, *found.rivals)]


def test_an_effect_that_short_windows_cannot_identify_competes_with_those_found_there() -> None:
    made = simulated_runs([{"effect": "clock_drift", "rate": 0.008}], name="swamp")
    continuation = continued(made)
    known = by_label(candidates(made.boat, SECONDS))
    rivals = [known["clock_offset"], known["clock_drift"]]
    caught = fit_by_continuation(continuation, Hypothesis((known["clock_offset"],)), np.array([0.1]))
    with using(most_effects=1):  # in its place, not beside it
        best, others = with_small_effects(continuation, caught, rivals, ["clock_offset"])
    every = [continuation.at(LAST, one) for one in (best, *others)]
    assert min(every, key=continuation.criterion).hypothesis.label == "clock_drift"


def test_whole_runs_show_waves_beside_windows_of_twenty_seconds_that_leave_noise() -> None:
    made = simulated_runs([{"effect": "waves", "force": 1.0, "frequency": 0.4, "from": 0.5}], 1, name="swamp")
    continuation = continued(made)
    nothing = fit_by_continuation(continuation, Hypothesis(), np.zeros(0))
    assert continuation.is_adequate(MIDDLE, nothing)
    waves = by_label(candidates(made.boat, SECONDS))["waves"]
    best, _ = with_small_effects(continuation, nothing, [waves], ["waves"])
    assert best.hypothesis.label == "waves" and best.x[1] == pytest.approx(0.4, abs=0.003)


def test_the_loss_of_a_run_is_that_of_its_stretches_of_twenty_seconds() -> None:
    continuation = continued(simulated_runs([], seed=21, name=UNSTABLE))
    problem, nothing = continuation.problems[LAST], continuation.fit(LAST, Hypothesis(), np.zeros(0))
    lost = stretch_losses(problem, nothing).reshape(problem.windows.count, -1)
    squares = nothing.residual.reshape(problem.windows.count, -1, 6) ** 2
    for run in range(problem.windows.count):
        for stretch, first in enumerate(range(0, squares.shape[1], 200)):
            rows = slice(first, first + 200)
            seen = (problem.windows.weight[run, rows] > 0).sum()
            assert lost[run, stretch] == pytest.approx(seen * np.log(1 + squares[run, rows].sum() / seen))


def test_numbers_of_other_runs_explain_a_run_less_well_than_its_own() -> None:
    continuation = continued(
        simulated_runs([{"effect": "current", "north": 0.004, "east": -0.003}], seed=21, name=UNSTABLE)
    )
    instance = by_label(INSTANCES)["current"]
    made = continuation.fit(LAST, Hypothesis((instance,)), np.zeros(2))
    problem, own = continuation.problems[LAST], made.loss.sum()
    lost, seen = stretch_losses(problem, made), (problem.windows.weight > 0).sum()
    assert own < seen * np.expm1(np.nansum(lost) / seen) < 1.01 * own + 20.0


@pytest.mark.parametrize(("size", "is_there"), [(0.004, True), (0.0, False)])
def test_a_current_is_confirmed_where_there_is_one_and_only_there(size: float, is_there: bool) -> None:
    continuation = continued(
        simulated_runs([{"effect": "current", "north": size, "east": -size}], seed=22, name=UNSTABLE)
    )
    instance = by_label(INSTANCES)["current"]
    nothing = continuation.fit(LAST, Hypothesis(), np.zeros(0))
    made = continuation.fit(LAST, Hypothesis((instance,)), np.zeros(2), nothing.states)
    assert confirmed_on(continuation, LAST, made, nothing, 120).holds == is_there


def test_an_effect_whose_start_diverges_is_tested_at_its_neutral_value() -> None:
    found = simulated_runs([{"effect": "yaw_damping", "scale": 0.5}], velocities=False, name=UNSTABLE)
    continuation = continued(found)
    nothing = continuation.fit(0, Hypothesis(), np.zeros(0))
    instance = by_label(INSTANCES)["yaw_damping"]
    wild = replace(instance, starts=((-3.0,),))
    scores = score_tests(continuation.problems[0], nothing, [wild])[0]
    assert np.isfinite(scores.expected_chi2)
    assert scores.information > 1000.0


def test_the_information_about_an_effect_is_the_greatest_of_all_starts() -> None:
    continuation = continued(simulated_runs([], name=UNSTABLE))
    problem, nothing = continuation.problems[0], continuation.fit(0, Hypothesis(), np.zeros(0))
    instances = [one for one in INSTANCES if is_small(one) and one.effect.name != "waves"]
    softly = {one.label: at_neutral_values(one, BOAT) for one in instances}
    alone = {
        one.instance.label: one.information for one in score_tests(problem, nothing, list(softly.values()))
    }
    scores = score_tests(problem, nothing, instances)
    assert all(one.information >= alone[one.instance.label] for one in scores)
    larger = [one for one in scores if one.information > 1.5 * alone[one.instance.label]]
    assert any(np.array_equal(one.x, softly[one.instance.label].starts[0]) for one in larger)
