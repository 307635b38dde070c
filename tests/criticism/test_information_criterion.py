"""The extended BIC: its charge by hand, and the same charge for adding an effect and for dropping it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates, differing, hull_nuisance
from swamp_rl.criticism.selection.information_criterion import InformationCriterion, information_criterion
from tests.support.criticism import simulated_runs

BOAT = load_boat("swamp")
KNOWN = by_label(candidates(BOAT, 40.0))
CRITERION = InformationCriterion(samples=10_000.0, candidates=40)


def test_nothing_is_charged_for_no_effect() -> None:
    assert CRITERION.charge(Hypothesis()) == 0.0


def test_a_parameter_is_charged_the_logarithm_of_the_samples_and_an_effect_its_choice() -> None:
    one, two = Hypothesis((KNOWN["mass"],)), Hypothesis((KNOWN["mass"], KNOWN["current"]))
    assert CRITERION.charge(one) == pytest.approx(math.log(10_000) + 2 * math.log(40))
    assert CRITERION.charge(two) == pytest.approx(3 * math.log(10_000) + 2 * math.log(40 * 39 / 2))


def test_parameters_of_each_run_are_charged_by_the_samples_of_a_run() -> None:
    by_run = differing(KNOWN["current"], "run", (0, 1, 2, 3, 4))
    expected = 10 * math.log(10_000 / 5) + 2 * math.log(40)
    assert CRITERION.charge(Hypothesis((by_run,))) == pytest.approx(expected)


def test_a_narrow_prior_costs_less_than_none() -> None:
    hull = hull_nuisance(BOAT)
    assert hull is not None
    free = replace(hull, specs=tuple(replace(spec, prior=None) for spec in hull.specs))
    assert CRITERION.charge(Hypothesis((hull,))) < CRITERION.charge(Hypothesis((free,)))


def test_what_adding_an_effect_must_gain_is_what_dropping_it_saves() -> None:
    before = Hypothesis((KNOWN["mass"],))
    after = before.with_instance(KNOWN["wind"])
    saved = CRITERION.charge(after) - CRITERION.charge(after.without("wind"))
    assert CRITERION.required_gain(before, KNOWN["wind"]) == pytest.approx(saved)


def test_the_candidates_are_those_of_the_boat() -> None:
    runs = simulated_runs([])
    found = information_criterion(runs, 5.0)
    assert found.candidates == len(candidates(runs.boat, 40.0, runs.groups))
    assert found.samples == 5.0
    assert np.isfinite(found.charge(Hypothesis(tuple(KNOWN.values()))))
