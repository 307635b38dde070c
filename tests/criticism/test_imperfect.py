"""A model that errs by more than its sensors: how large its errors are, and what stands out from them."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.adequacy import adequacy
from swamp_rl.criticism.candidates import Hypothesis, candidates
from swamp_rl.criticism.imperfect import correlated, in_noise, levelled
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.partial import found_despite
from tests.support.criticism import SECONDS, trials, wander

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_an_error_lasts_as_long_as_its_autocorrelation_says() -> None:
    rng = np.random.default_rng(0)
    errors = np.stack([wander(rng, (200, 400, 1), 1.0, 1.0)[..., 0]] * 6, axis=2)
    keep = np.exp(-0.1)
    assert correlated(errors) == pytest.approx((1.0 + keep) / (1.0 - keep), rel=0.15)
    assert correlated(rng.standard_normal((200, 400, 6))) == pytest.approx(1.0, abs=0.1)
    assert correlated(np.zeros((2, 40, 6))) == 1.0


def test_a_steady_wind_stands_out_from_gusts_that_no_cause_foretells() -> None:
    found = trials(
        [
            {"effect": "wind", "speed": 6.0, "from": 1.0},
            {"effect": "gusts", "speed_std": 1.5, "direction_std": 0.3, "time_constant": 8.0},
        ]
    )
    weight = weights(found, noise_levels(found))
    atoms = [
        atom
        for atom in candidates(found.boat, SECONDS)
        if atom.effect.name in ("wind", "mass", "position_delay")
    ]
    told = found_despite(found, weight, atoms, None)
    assert told is not None
    slow, search = told[0].slow, told[2]
    assert slow is not None and (slow[:2, 0] > 1.5 / weight.max(axis=(0, 1))[:2]).all()
    assert search.winner.hypothesis.label == "wind"
    assert np.hypot(*search.winner.x) == pytest.approx(6.0, rel=0.25)
    assert np.arctan2(*search.winner.x[::-1]) == pytest.approx(1.0, abs=0.25)
    assert search.confirmed["wind"].holds and not search.adequate


def test_what_is_left_is_judged_against_the_sensors_not_against_the_errors_it_was_weighed_by() -> None:
    found = trials([{"effect": "external_force", "north": 3.0, "east": -2.0}])
    weight = weights(found, noise_levels(found))
    level = levelled(found, weight, Hypothesis(), np.zeros(0))
    assert adequacy(level.problem, level.fit).adequate
    assert not adequacy(level.problem, in_noise(level.fit, level.problem, weight)).adequate


def test_channels_that_were_not_measured_have_no_error() -> None:
    found = trials([{"effect": "external_force", "north": 3.0, "east": -2.0}], velocities=False)
    level = levelled(found, weights(found, noise_levels(found)), Hypothesis(), np.zeros(0))
    assert (level.errors[3:5, 0] == 0.0).all() and (level.errors[[0, 1, 2, 5], 0] > 0.0).all()
    assert np.isfinite(level.fit.chi2)
    assert level.trials.slow is not None and replace(level.trials, slow=None).slow is None
