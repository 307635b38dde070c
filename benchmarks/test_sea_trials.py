"""The reading of the sea trials: figures against closed forms, and a fit that finds what made the figures."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.sea_trials import advance, limit, separation, share_words, together, wrong_words
from benchmarks.sea_trials_model import (
    NOTHING,
    PUBLISHED,
    Figure,
    Run,
    fitted,
    of_atom,
    predicted,
    with_even_factor,
)
from swamp_rl.boat import load_boat
from swamp_rl.criticism.candidates import by_label, candidates
from swamp_rl.simulator import parameters

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp-light")
ATOMS = by_label(candidates(BOAT, 120.0))


def test_the_boat_file_makes_the_figures_of_the_reference_and_the_ends_of_its_own_curve() -> None:
    made = predicted(BOAT, parameters(BOAT), PUBLISHED)
    assert made[0] == pytest.approx(1.20, abs=0.01)  # two bow thrusters
    assert made[2:4] == pytest.approx([0.30, 0.75], abs=0.01)
    assert made[4:6] == pytest.approx([6.5, 0.83], abs=0.05)  # circle at 30 degrees


def test_a_boat_on_a_line_pulls_with_the_thrust_that_the_deduction_leaves() -> None:
    pull = Figure("pull", Run(0, 0, (0.6,) * 4, 5.0), "pull", 0.0, 1.0)
    bollard = 4 * 12.2 * 0.6**2
    curve = 0.30 + (0.6 - 0.3) / 0.7 * 0.45
    assert predicted(BOAT, parameters(BOAT), [pull])[0] == pytest.approx(bollard * curve, rel=1e-3)
    even = with_even_factor(None, "even")
    assert predicted(BOAT, even.apply(BOAT, np.array([0.8])), [pull])[0] == pytest.approx(
        bollard * 0.8, rel=1e-3
    )


def test_a_fit_finds_the_effect_that_made_the_figures_and_says_that_it_fits() -> None:
    model = of_atom(ATOMS["resistance"])
    ahead = PUBLISHED[:2]
    values = predicted(BOAT, model.apply(BOAT, np.array([1.3])), ahead)
    figures = [replace(f, value=float(v)) for f, v in zip(ahead, values, strict=True)]
    found = fitted(BOAT, model, figures, wide=False)
    assert found.x[0] == pytest.approx(1.3, abs=0.01)
    assert found.chi2 < 0.1 < fitted(BOAT, NOTHING, figures).chi2


def test_a_trial_separates_models_by_what_a_refit_cannot_take_up() -> None:
    ahead = PUBLISHED[:2]
    truth, rival = (
        fitted(BOAT, NOTHING, ahead),
        fitted(BOAT, of_atom(ATOMS["thrust_scale"]), ahead, wide=False),
    )
    again = separation(BOAT, truth, rival, ahead, replace(ahead[0], error=0.3))
    assert again == pytest.approx(0.0, abs=0.2)  # the same trial with a worse log tells nothing new
    even = fitted(BOAT, with_even_factor(None, "even"), ahead, wide=False)
    pull = Figure("pull", Run(0, 0, (0.3,) * 4, 5.0), "pull", 0.0, 0.3)
    assert separation(BOAT, truth, even, ahead, pull) > 3.0


def test_two_effects_together_are_one_model_with_all_numbers() -> None:
    both = together(ATOMS["resistance"], ATOMS["azimuth_lag"])
    assert both.name == "azimuth_lag + resistance" and len(both.start) == len(both.numbers) == 2
    assert limit(2) == pytest.approx(12.592, abs=0.01)  # chi2 of six degrees of freedom at 95 %


def test_what_the_boat_file_gets_wrong_is_said_of_the_figures_that_it_misses() -> None:
    made = predicted(BOAT, parameters(BOAT), PUBLISHED)
    right = [replace(f, value=float(v)) for f, v in zip(PUBLISHED, made, strict=True)]
    assert wrong_words(BOAT, right).endswith("Beyond: none.")
    off = [*right[:4], replace(right[4], value=right[4].value / 1.5)]
    assert wrong_words(BOAT, off).endswith("Beyond: tactical diameter of circle, 30 degrees (+50%).")


def test_the_share_that_the_jet_loses_is_said_beside_the_curve() -> None:
    shares = [ahead / own for _, ahead, own, _ in advance(BOAT)]
    told = share_words(BOAT)
    assert f"between {min(shares):.2f} and {max(shares):.2f}, while the curve goes from 0.30 to 0.75" in told
