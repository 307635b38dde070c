"""The Bayes classifier of the linearised problem: what it cannot miss, and what it cannot know."""

import numpy as np
import pytest
from swamp_rl.experiments.synthetic.cases import Case

from benchmarks.blind.bound import bound_of
from benchmarks.blind.classifier import classifier_rates, columns_of_truth, sensitivities
from swamp_rl.boat import load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.simulator import initial_state, parameters

pytestmark = [pytest.mark.slow, pytest.mark.numerical]
BOAT = load_boat("swamp")


def of_drag(scale: float) -> Case:
    return Case("P", "single", [{"effect": "resistance", "scale": scale}])


def rates(case: Case) -> tuple[float, float]:
    found = classifier_rates(case, np.random.default_rng(1), True, 2, 30.0)
    return found.first, found.among_three


def test_an_effect_of_no_size_is_never_named_and_a_large_one_always() -> None:
    assert rates(of_drag(1.0)) == (0.0, 0.0)
    assert rates(of_drag(1.5)) == (1.0, 1.0)


def test_the_rate_grows_with_the_evidence_and_a_set_of_three_holds_no_less_than_the_first() -> None:
    unit = bound_of(of_drag(1.01), np.random.default_rng(1), True, 2, 30.0).evidence / 0.01
    found = [rates(of_drag(1.0 + evidence / unit)) for evidence in (3.0, 5.0, 8.0)]
    assert [among for _, among in found] == sorted(among for _, among in found)
    assert all(first <= among for first, among in found)
    assert found[0][1] < 0.3
    assert found[2][1] > 0.9


def test_what_an_initial_state_explains_is_no_evidence() -> None:
    case = Case("P", "single", [{"effect": "heading_bias", "bias": 0.01}])
    (entry,) = parse_effects(case.effects, "truth", BOAT.thruster_names)
    still = initial_state(parameters(BOAT), np.zeros((1, 3)))
    given = np.zeros((100, 2 * len(BOAT.thrusters)))
    seen = np.ones(100, dtype=bool)
    noise = np.array([np.inf, np.inf, 0.01, np.inf, np.inf, np.inf])
    slopes = sensitivities(BOAT, columns_of_truth(BOAT, entry), still, given, seen, noise)
    assert np.abs(slopes).max() < 1e-3 * 100.0
