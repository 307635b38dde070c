"""What a diagnosis says of its evidence: trivial predictors, measured weather, the share of each cause."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet, read_run_set
from swamp_rl.criticism.diagnose import diagnose, examine
from swamp_rl.criticism.inference.cause_share import (
    CauseList,
    Witness,
    carries_over,
    is_minor,
    without_equal_rivals,
)
from swamp_rl.criticism.likelihood.prediction_error import trivial_predictors
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.report.evidence import carry_over_sentence, predictors_sentence, share_text
from swamp_rl.criticism.report.page import opening
from swamp_rl.criticism.result import Cause, Diagnosis, Gain, Paired, Predictors, Share
from swamp_rl.criticism.selection.backward_elimination import Selection, fit_by_continuation
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from swamp_rl.effects import parse_effects
from swamp_rl.runs import Run, write_run
from swamp_rl.simulator.replay import replay
from tests.support.criticism import DT, SIGMA, commands, simulated_runs

pytestmark = pytest.mark.xdist_group("evidence")  # what they share is made once

WIND = {"effect": "wind", "speed": 5.0, "from": 1.0}
NOISE = {"north": 0.02, "east": 0.02, "heading": 0.005}


def predictors_of(runs: RunSet) -> dict[float, dict[str, float]]:
    found = trivial_predictors(runs, weights(runs, noise_levels(runs)))
    return {one.horizon_s: one.model_dump(exclude={"horizon_s"}) for one in found}


def share(
    without: float, with_cause: float, interval: tuple[float, float] = (0.0, 1.0), moved: float = 0.01
) -> Share:
    return Share(
        horizon_s=10.0,
        quantity="position_rmse_m",
        without=without,
        with_cause=with_cause,
        ci95=interval,
        moved=moved,
    )


def test_a_true_boat_file_predicts_better_than_any_trivial_predictor() -> None:
    found = predictors_of(simulated_runs([]))
    for horizon in (5.0, 10.0, 30.0):
        errors = found[horizon]
        assert errors["boat_file"] < 0.5 * min(
            errors[n] for n in ("at_rest", "constant_velocity", "no_thrust")
        )


def test_all_predictors_start_where_the_boat_file_does() -> None:
    runs = simulated_runs([])
    runs.measured[:, :60, :2] += 1000.0  # before the first row that is compared
    runs.first_compared[:] = 80
    found = predictors_of(runs)[5.0]
    assert max(found.values()) < 10.0


def test_constant_velocity_beats_a_boat_file_whose_thrust_is_twice_the_true_one() -> None:
    runs = simulated_runs([])
    boat = load_boat("swamp")
    strong = parse_effects([{"effect": "thrust_scale", "scale": 3.0}], "test", boat.thruster_names)
    errors = predictors_of(replace(runs, boat=boat.model_copy(update={"effects": strong})))[1.0]
    assert errors["boat_file"] > errors["constant_velocity"]


def test_a_boat_at_rest_is_predicted_best_by_staying_at_rest() -> None:
    runs = simulated_runs([])
    still = np.zeros_like(runs.measured) + SIGMA * np.random.default_rng(1).standard_normal(
        runs.measured.shape
    )
    errors = predictors_of(replace(runs, measured=still))[10.0]
    assert errors["at_rest"] == min(errors.values())


@pytest.mark.parametrize(
    ("verdict", "after", "advised", "better"),
    [
        ("cause", 0.1, False, True),
        ("cause", 9.9, True, False),
        ("unexplained", 0.1, True, True),
        ("unexplained", 9.9, True, False),
    ],
)
def test_to_fit_the_numbers_is_advised_unless_a_cause_mends_the_prediction(
    verdict: str, after: float, advised: bool, better: bool
) -> None:
    errors = Predictors(horizon_s=30.0, boat_file=17.0, at_rest=26.0, constant_velocity=9.0, no_thrust=18.0)
    paired = Paired(before=17.0, after=after, ci95=(1.0, 2.0))
    gain = Gain(horizon_s=30.0, restarts=9, blocks="windows", position_rmse_m=paired)
    message = predictors_sentence(
        Diagnosis.model_construct(verdict=verdict, predictors=[errors], gain=[gain])
    )
    assert "no better than constant velocity: 17 m against 9 m" in message
    assert ("identify boat" in message) == advised
    assert ("The extended boat predicts better than both" in message) == better


class BegunError(Exception):
    """The search of a diagnosis has begun."""


@pytest.mark.parametrize(
    ("effects", "said"), [([], False), ([{"effect": "thrust_scale", "scale": 0.0}], True)]
)
def test_a_boat_file_no_better_than_a_boat_at_rest_is_reported_before_the_search(
    effects: list[dict[str, object]],
    said: bool,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    def begin(*given: object) -> None:
        raise BegunError

    monkeypatch.setattr("swamp_rl.criticism.diagnose.select_model", begin)
    with caplog.at_level("INFO", LOG.name), pytest.raises(BegunError):
        examine(simulated_runs(effects), None, np.random.default_rng(0))
    assert ("5 s ahead no better than a boat at rest" in caplog.text) == said
    assert ("if its numbers are guesses, fit them first" in caplog.text) == said


def test_a_cause_is_minor_only_below_two_percent_and_below_the_noise() -> None:
    assert is_minor([share(2.0, 1.99)], NOISE)
    assert not is_minor([share(2.0, 1.9)], NOISE)  # 5 % of the error
    assert not is_minor([], NOISE)


def test_a_cause_whose_share_may_be_chance_is_minor_below_the_noise() -> None:
    assert is_minor([share(2.0, 1.9, interval=(-0.1, 0.3))], NOISE)
    assert not is_minor([share(2.0, 1.9, interval=(-0.1, 0.3)), share(2.0, 1.9)], NOISE)
    assert not is_minor([share(2.0, 1.9, interval=(-0.1, 0.3), moved=0.2)], NOISE)


def test_a_cause_without_a_share_is_minor_unless_it_moves_predictions_by_more_than_the_noise() -> None:
    assert is_minor([share(2.0, 2.1)], NOISE)
    assert not is_minor([share(2.0, 2.1, moved=0.2)], NOISE)


def test_a_cause_without_a_share_is_reported_by_how_far_it_moves_the_prediction() -> None:
    def sentence(*errors: float) -> str:
        cause = Cause(effect="mass", parameters={}, share=[share(*errors, moved=0.2)])
        return share_text(cause, Diagnosis.model_construct(gain_on="other_runs", gain=[]))

    assert sentence(2.0, 1.0) == "50 % of the position error 10 s ahead (2 m without it, 1 m with it)"
    assert sentence(2.0, 2.1) == (
        "no share of the position error 10 s ahead (2 m without it, 2.1 m with it); "
        "it moves the prediction by 0.2 m"
    )


def test_weather_without_a_share_on_other_runs_is_said_not_to_act_there() -> None:
    def sentence(effect: str, gain_on: str, horizon: float) -> str:
        paired = Paired(before=2.0, after=1.0, ci95=(0.5, 1.5))
        gain = Gain(horizon_s=horizon, restarts=9, blocks="windows", position_rmse_m=paired)
        found = Diagnosis.model_construct(gain_on=gain_on, gain=[gain])
        return share_text(Cause(effect=effect, parameters={}), found)

    assert "another day" in sentence("wind", "other_runs", 30.0)
    assert sentence("wind", "same_run", 30.0) == sentence("mass", "other_runs", 30.0) == ""
    assert sentence("wind", "other_runs", 5.0) == ""  # too short for a share


def test_a_cause_that_moves_predictions_by_more_than_the_noise_matters_beside_a_larger_error() -> None:
    assert not is_minor([share(2.0, 1.99, moved=0.2)], NOISE)  # 2.0^2 = 1.99^2 + 0.2^2


@pytest.mark.parametrize(("offset", "differs"), [(0.0, False), (0.2, True)])
def test_a_rival_that_adds_what_moves_no_prediction_is_none(offset: float, differs: bool) -> None:
    turned = {"effect": "azimuth_offset", "thruster": "bs", "offset": offset}
    runs = simulated_runs([{"effect": "thrust_scale", "scale": 0.8}, turned])
    known = by_label(candidates(runs.boat, 40.0))
    weight = weights(runs, noise_levels(runs))
    continuation = continuation_of(runs, weight)
    thrust = Hypothesis((known["thrust_scale"],))
    best = fit_by_continuation(continuation, thrust, np.array([0.8]))
    both = thrust.with_instance(known["azimuth_offset bs"])
    rival = fit_by_continuation(continuation, both, np.array([0.01, 0.8]))
    found = Selection(best, True, MIDDLE, [rival], [], [], [])
    listed = CauseList([Cause(effect="thrust_scale", parameters={})], [], [], True)
    on, rng = [Witness(runs, weight, others=False)], np.random.default_rng(0)
    noise = dict(zip(CHANNELS, SIGMA.tolist(), strict=True))
    kept = without_equal_rivals(continuation, found, listed, on, noise, rng).rivals
    assert kept == ([rival] if differs else [])


def test_a_cause_whose_interval_lies_below_zero_does_not_carry_over() -> None:
    assert carries_over([share(1.0, 1.2, (-0.5, 0.1))])
    assert not carries_over([share(1.0, 1.2, (-0.5, -0.1))])


def test_the_sentence_on_a_cause_that_does_not_carry_over_begins_as_one() -> None:
    worse = share(1.0, 1.2, (-0.5, -0.1))
    cause = Cause(effect="linear_drag", parameters={}, share=[worse], carries_over=False)
    found: Any = SimpleNamespace(causes=[cause], minor=[], nuisance=[])
    assert carry_over_sentence(found).startswith("Linear drag does not carry over: ")


@pytest.fixture(scope="module")
def windy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three runs in a wind that an anemometer measured."""
    folder = tmp_path_factory.mktemp("windy")
    boat = load_boat("swamp")
    blown = boat.model_copy(update={"effects": parse_effects([WIND], "test", boat.thruster_names)})
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in boat.thruster_names]
    rng = np.random.default_rng(3)
    for number in range(3):
        command = commands(number)
        columns = dict(zip(names, command.T, strict=True)) | {"time": DT * np.arange(len(command))}
        columns |= {name: np.zeros(len(command)) for name in ("north", "east", "heading")}
        columns = replay(blown, Run("one", columns)).columns
        for name, sigma in zip(("north", "east", "heading", "surge", "sway", "yaw_rate"), SIGMA, strict=True):
            columns[name] = columns[name] + sigma * rng.standard_normal(len(command))
        columns["heading"] = np.arctan2(np.sin(columns["heading"]), np.cos(columns["heading"]))
        kept = {name: values for name, values in columns.items() if not name.startswith("applied_")}
        kept |= {"wind_speed": np.full(len(command), 5.0), "wind_from": np.full(len(command), 1.0)}
        write_run(folder / f"run{number}.csv", Run(f"run{number}", kept))
    return folder


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_a_measured_wind_is_an_input_and_no_cause(windy: Path, tmp_path: Path) -> None:
    found = diagnose(windy, "swamp", tmp_path / "out")
    assert found.verdict == "nothing_wrong"
    assert not (tmp_path / "out" / "conditions.yaml").exists()
    boat = load_boat("swamp")
    runs = (read_run_set(windy, boat, "swamp", ignore) for ignore in ([], ["wind"]))
    assert [one.wind for one in runs] == ["measured", "ignored"]


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_an_ignored_wind_is_named_and_written_beside_the_boat_file(windy: Path, tmp_path: Path) -> None:
    found = diagnose(windy, "swamp", tmp_path / "out", ignore=["wind"])
    assert [cause.effect for cause in found.causes] == ["wind"]
    largest = max(found.causes[0].share, key=lambda one: one.horizon_s)
    assert largest.with_cause < 0.5 * largest.without
    assert load_boat(tmp_path / "out" / "extended_boat.yaml").effects == ()
    (written,) = yaml.safe_load((tmp_path / "out" / "conditions.yaml").read_text())["effects"]
    assert written["effect"] == "wind"
    assert written["speed"] == pytest.approx(5.0, rel=0.1)


def test_the_page_begins_with_what_the_runs_are_called() -> None:
    runs = simulated_runs([])
    text = opening(
        Diagnosis.model_construct(verdict="nothing_wrong", predictors=[], causes=[], minor=[], nuisance=[]),
        runs,
        "Bora/Tag <1>",
    )
    assert "against 3 runs of <b>Bora/Tag &lt;1&gt;</b>, 2.0 minutes in all" in text
