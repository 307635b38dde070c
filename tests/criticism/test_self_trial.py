"""Twins of a diagnosis, and how often its answer is found again in them."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from swamp_rl.criticism.data.measurement_noise import (
    noise_levels,
    repeated_samples,
    third_differences,
    weights,
)
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.linearised_selection import linearised_answers
from swamp_rl.criticism.inference.self_trial import (
    OMITTED,
    SensorNoise,
    Twins,
    causes_in,
    noise_of,
    searched,
    sensor_noise,
    with_noise,
    without_noise,
)
from swamp_rl.criticism.model.candidates import candidates
from swamp_rl.criticism.nuisance.smoothed_channels import smoothed_channels
from swamp_rl.criticism.report.evidence import self_trial_section, self_trial_sentence
from swamp_rl.criticism.result import Diagnosis, SelfTrial, SmoothedNoise
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import Continuation, continuation_of
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.criticism import DT, SECONDS, SIGMA, driven, simulated_runs

ROOT = Path(__file__).parents[2]
NO_PROCESS = np.zeros((0, 6, 2))
SMALL_ONES = ("mass", "yaw_inertia", "sway_drag", "thrust_scale", "resistance", "linear_drag")


def chosen(runs: RunSet, *effects: str) -> tuple[Continuation, Selection]:
    """The selection from those effects alone."""
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    every = [one for one in candidates(runs.boat, SECONDS) if one.effect.name in effects]
    return continuation, beam_search(continuation, every, None)


def answers(runs: RunSet, *effects: str, twins: int = 20) -> tuple[str, list[str]]:
    """The answer to the runs, and to each of its twins, among those effects."""
    continuation, found = chosen(runs, *effects)
    noise = sensor_noise(noise_levels(runs), {}, None, runs.dt)
    noises = [noise_of(runs, noise, 0, number) for number in range(twins)]
    every = [one for one in candidates(runs.boat, SECONDS) if one.effect.name in effects]
    made = linearised_answers(continuation, found, noises, every)
    return found.winner.hypothesis.label, [one.label for one in made]


def twins_of(runs: RunSet, *effects: str) -> Twins:
    continuation, found = chosen(runs, *effects)
    judged = continuation.problem(found.stage, found.winner.hypothesis)
    noise = sensor_noise(noise_levels(runs), {}, None, runs.dt)
    return Twins(runs, without_noise(runs, judged, found.winner), noise, 7)


def test_white_noise_has_the_estimated_deviation_and_no_correlation() -> None:
    drawn = SensorNoise(SIGMA, NO_PROCESS).drawn(np.random.default_rng(1), 5, 4000, DT)
    assert drawn.std(axis=(0, 1)) == pytest.approx(SIGMA, rel=0.03)
    neighbours = (drawn[:, 1:] * drawn[:, :-1]).mean(axis=(0, 1)) / SIGMA**2
    assert np.abs(neighbours).max() < 0.03


def test_a_wandering_position_has_the_estimated_size_and_time_constant() -> None:
    wander = np.tile([0.0, 0.0, 1.0], (6, 1))
    wander[:2, :2] = 0.8, 5.0
    noise = sensor_noise(np.full(6, 1e-9), {}, wander, DT)
    drawn = noise.drawn(np.random.default_rng(2), 40, 4000, DT)[..., :2]
    assert drawn.std() == pytest.approx(0.8, rel=0.05)
    apart = round(5.0 / DT)
    correlation = (drawn[:, apart:] * drawn[:, :-apart]).mean() / drawn.var()
    assert correlation == pytest.approx(np.exp(-1.0), abs=0.06)


def test_the_noise_of_a_smoothed_channel_is_recognised_as_the_filter_that_it_was_estimated_as() -> None:
    entries = {"heading": SmoothedNoise(sample_noise=0.002, standard_deviation=0.01, time_constant_s=0.4)}
    noise = sensor_noise(SIGMA, entries, None, DT)
    still = simulated_runs([])
    drawn = noise.drawn(np.random.default_rng(3), 3, 3000, DT)
    at_sample_rate = np.std(np.concatenate([third_differences(run[:, 2]) for run in drawn])) / np.sqrt(20.0)
    assert at_sample_rate == pytest.approx(0.002, rel=0.05)
    runs = replace(
        still, commands=np.zeros((3, 3000, 8)), measured=drawn, lengths=np.full(3, 3000, dtype=np.int64)
    )
    found = smoothed_channels(runs)
    assert list(found) == ["heading"]
    assert found["heading"].time_constant_s == pytest.approx(0.4, rel=0.2)


def test_a_twin_lacks_and_repeats_what_the_measured_runs_lack_and_repeat() -> None:
    runs = simulated_runs([])
    runs.measured[0, 200, 1] = np.nan
    runs.measured[1, 150:153, 2] = runs.measured[1, 149, 2]
    ideal = replace(runs, measured=np.where(np.isfinite(runs.measured), 0.0, np.nan))
    noise = np.random.default_rng(4).standard_normal(runs.measured.shape)
    twin = with_noise(runs, ideal, noise)
    assert np.array_equal(np.isnan(twin.measured), np.isnan(runs.measured))
    assert np.array_equal(repeated_samples(twin.measured), repeated_samples(runs.measured))
    assert np.array_equal(twin.commands, runs.commands)


def test_the_answer_of_a_hypothesis_leaves_out_minor_causes_and_a_nuisance_beside_others() -> None:
    label = "hull_coefficients + mass + thruster_gain bs"
    assert causes_in(label) == "mass + thruster_gain bs"
    assert causes_in(label, {"mass"}) == "thruster_gain bs"
    assert causes_in("hull_coefficients") == "hull_coefficients"
    assert causes_in("mass", {"mass"}) == causes_in("nothing") == "nothing"


def diagnosis_of(verdict: str, **changes: Any) -> Diagnosis:
    """A diagnosis with a self-trial and nothing else in it."""
    empty = ("causes", "indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    values: dict[str, Any] = {name: [] for name in empty} | {"separating_trial": None, "noise": {}}
    trial = SelfTrial.model_validate({"named": 18, "of": 20} | changes)
    return Diagnosis(verdict=verdict, **values, adequacy={}, elapsed_s=1.0, self_trial=trial)  # type: ignore[arg-type]


def test_the_sentence_counts_what_was_named_and_what_instead() -> None:
    found = diagnosis_of("cause", confused_with={"wind": 1, "thruster_gain bs + mass": 1, "nothing": 3})
    assert self_trial_sentence(found) == (
        "Self-trial: named 18 of 20 times; once wind instead; once thruster gain (bs) and mass instead; "
        "3 times nothing instead."
    )
    clean = diagnosis_of("nothing_wrong", named=20)
    assert self_trial_sentence(clean) == "Self-trial: diagnosed as nothing wrong 20 of 20 times."
    assert "linearised" in self_trial_section(clean)
    assert "linearised" not in self_trial_section(diagnosis_of("cause", method="search"))


def test_where_nothing_explains_the_runs_one_sentence_says_why_there_is_no_self_trial() -> None:
    found = diagnosis_of("unexplained", named=0, of=0, omitted=OMITTED)
    assert self_trial_sentence(found).startswith("No self-trial: no set of effects explains the runs")
    assert self_trial_section(found).count("<p>") == 1
    without = found.model_copy(update={"self_trial": None})
    assert self_trial_sentence(without) == self_trial_section(without) == ""


def test_the_schema_holds_the_self_trial_and_refuses_another_method() -> None:
    published = json.loads((ROOT / "docs" / "diagnosis.schema.json").read_text())
    assert set(published["$defs"]["SelfTrial"]["required"]) == {"named", "of"}
    assert diagnosis_of("cause").model_dump()["self_trial"]["method"] == "linearised"
    with pytest.raises(ValidationError):
        diagnosis_of("cause", method="guess")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--self-trial", "-1"), "--self-trial"),
        (("--self-trial", "many"), "--self-trial"),
        (("--workers", "2"), "add --search-twins"),
        (("--search-twins", "--self-trial", "0"), "asks for no twins"),
    ],
)
def test_wrong_arguments_are_refused_and_nothing_is_written(
    call: Call, tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    (tmp_path / "runs").mkdir()
    code, _, error = call("diagnose", tmp_path / "runs", "--out", tmp_path / "out", *words)
    assert code == 2 and message in error
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.numerical
def test_twins_differ_from_the_answer_by_the_estimated_noise_alone() -> None:
    runs = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.8}])
    twins = twins_of(runs, "thruster_gain")
    after = slice(int(runs.first_compared.max()), None)
    difference = (twins.run_set(0).measured - twins.ideal.measured)[:, after]
    assert difference.std(axis=(0, 1)) == pytest.approx(noise_levels(runs), rel=0.06)
    assert noise_levels(twins.run_set(1)) == pytest.approx(noise_levels(runs), rel=0.12)
    assert np.array_equal(twins.run_set(3).measured, twins.run_set(3).measured)
    assert not np.array_equal(twins.run_set(3).measured, twins.run_set(4).measured)
    residual = (runs.measured - twins.ideal.measured)[:, after] / SIGMA
    assert (residual**2).mean() == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.numerical
def test_an_obvious_fault_is_named_in_every_twin() -> None:
    fault = {"effect": "thruster_gain", "thruster": "bs", "gain": 0.7}
    own, named = answers(simulated_runs([fault], seed=3), "thruster_gain", "mass", "resistance")
    assert own == "thruster_gain bs"
    assert named == [own] * 20


@pytest.mark.slow
@pytest.mark.numerical
def test_explanations_of_one_speed_are_confused() -> None:
    ahead = np.zeros((3, 400, 8))
    ahead[..., 4:] = 0.7
    runs = driven([{"effect": "thrust_scale", "scale": 0.85}], ahead, 1.1, seed=5)
    own, named = answers(runs, "thrust_scale", "resistance", "linear_drag", twins=40)
    assert own != "nothing"
    assert 0 < sum(one == own for one in named) < 40
    assert {"thrust_scale", "resistance", "linear_drag"} >= set(named)


@pytest.mark.slow
@pytest.mark.numerical
def test_a_fault_at_the_threshold_is_sometimes_missed() -> None:
    runs = simulated_runs([{"effect": "mass", "mass": 58.06}], seed=4)  # 4.6 standard errors above the file
    own, named = answers(runs, "mass", "yaw_inertia", twins=40)
    assert own == "mass"
    assert 5 < sum(one == own for one in named) < 40
    assert "nothing" in named


@pytest.mark.slow
@pytest.mark.numerical
def test_of_clean_runs_nothing_is_found_in_any_twin() -> None:
    assert answers(simulated_runs([], seed=6), *SMALL_ONES) == ("nothing", ["nothing"] * 20)


@pytest.mark.slow
@pytest.mark.numerical
def test_the_linearised_criterion_answers_as_a_search_of_each_twin_does() -> None:
    runs = simulated_runs([{"effect": "mass", "mass": 58.06}], seed=4)
    _, named = answers(runs, *SMALL_ONES, twins=10)
    twins = replace(twins_of(runs, *SMALL_ONES), seed=0)
    found = [chosen(twins.run_set(number), *SMALL_ONES)[1] for number in range(10)]
    assert len(set(named)) > 1
    same = [one == other.winner.hypothesis.label for one, other in zip(named, found, strict=True)]
    assert sum(same) >= 9


@pytest.mark.slow
@pytest.mark.numerical
def test_a_search_of_twins_has_the_same_answers_on_one_worker_and_on_two() -> None:
    from swamp_rl.workers import answers

    runs = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.7}], seed=3)
    work: Any = partial(searched, twins_of(runs, "thruster_gain"))
    one, two = (list(answers(work, ["0", "1"], workers)) for workers in (1, 2))
    assert one == two == ["thruster_gain bs"] * 2
