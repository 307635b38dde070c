"""The wind's coefficients that a boat file takes by analogy, a nuisance beside a wind."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates, nuisances
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.criticism.selection.score_test import score_tests
from tests.support.criticism import SECONDS, simulated_runs

NAME = "wind_coefficients"
DEVIATIONS = {"c_x": 0.2, "c_y": 0.2, "c_n": 0.15, "lateral_area": 0.21, "frontal_area": 0.15}
OTHERS = {"lateral_centre": 0.2}


def boat_with(deviations: dict[str, float], folder: Path) -> Boat:
    """SWAMP, whose file gives the numbers of its wind these standard deviations."""
    plain = load_boat("swamp")
    wind = {
        name: {"value": getattr(plain.wind, name), "sd": sd, "provenance": "assumed", "source": "guessed"}
        | {"unit": plain.provenance[f"wind.{name}"].unit}
        for name, sd in deviations.items()
    }
    (folder / "boat.yaml").write_text(yaml.safe_dump({"extends": "swamp", "wind": wind}))
    return load_boat(folder / "boat.yaml")


@pytest.fixture(scope="module")
def guessed(tmp_path_factory: pytest.TempPathFactory) -> Boat:
    return boat_with(DEVIATIONS | OTHERS, tmp_path_factory.mktemp("guessed"))


def test_the_priors_of_the_winds_coefficients_are_the_boat_files_standard_deviations(guessed: Boat) -> None:
    wind, own = guessed.wind, by_label(nuisances(guessed))[NAME]
    expected = [np.hypot(0.2, 0.5 * wind.c_x), np.hypot(0.2, 0.5 * wind.c_y), 0.2, 0.15]
    assert [spec.prior for spec in own.specs] == pytest.approx(expected)
    means = [wind.c_x, wind.c_y, wind.lateral_centre, wind.c_n]
    assert [spec.mean for spec in own.specs] == pytest.approx(means)


def test_coefficients_without_a_standard_deviation_are_taken_as_known(tmp_path: Path) -> None:
    for boat in (load_boat("swamp"), boat_with(DEVIATIONS, tmp_path)):
        assert NAME not in by_label(nuisances(boat))


def test_the_winds_coefficients_come_and_go_with_the_wind(guessed: Boat) -> None:
    coefficients = by_label(nuisances(guessed))[NAME]
    known = by_label(candidates(guessed, SECONDS))
    both = Hypothesis((known["mass"],)).with_instance(known["wind"]).with_instance(coefficients)
    assert both.without("wind").label == "mass"
    assert both.without("mass").label == f"wind + {NAME}"
    found = simulated_runs([{"effect": "wind", "speed": 4.0, "from": 1.0}])
    problem = continuation_of(found, weights(found, noise_levels(found))).problems[0]

    def tested_beside(hypothesis: Hypothesis, x: list[float]) -> list[str]:
        at: Fit = fit(problem, hypothesis, np.array(x), problem.initial_states(), 1)
        return [one.instance.label for one in score_tests(problem, at, [coefficients, known["mass"]])]

    assert tested_beside(Hypothesis(), []) == ["mass"]
    assert sorted(tested_beside(Hypothesis((known["wind"],)), [2.0, 3.0])) == ["mass", NAME]


def test_a_wind_on_a_boat_of_guessed_coefficients_is_not_taken_for_an_external_force(guessed: Boat) -> None:
    truth = [
        {"effect": "wind", "speed": 6.0, "from": 1.0},
        {"effect": NAME, "c_x": 0.5, "c_y": 0.7, "lateral_centre": 0.1, "c_n": -0.05},
    ]
    found = replace(simulated_runs(truth), boat=guessed)
    weight = weights(found, noise_levels(found))
    every = [one for one in candidates(guessed, SECONDS) if one.effect.name in ("wind", "external_force")]
    kept = beam_search(continuation_of(found, weight), [*every, by_label(nuisances(guessed))[NAME]], None)
    assert kept.winner.hypothesis.label == f"wind + {NAME}"
    assert kept.winner.hypothesis.cause_label == "wind"
    assert kept.adequate and not kept.rivals
    values = dict(zip(("c_x", "c_y", "lateral_centre", "c_n"), kept.winner.x[2:], strict=True))
    assert values["lateral_centre"] == pytest.approx(0.1, abs=0.1)
    assert values["c_n"] == pytest.approx(-0.05, abs=0.05)
