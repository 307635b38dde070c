"""Whether what is left over moves the boat or only its receiver."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.colour import wandering
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.ladder import MIDDLE, ladder_of
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.unsteady import random_forces
from tests.support.criticism import wander
from tests.support.unmodelled_forces import DEAD_ZONE, MOORING, SECTOR, sailed

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

PIECES, PIECE = 5, 1.0


def pushed(rng: np.random.Generator, windows: int, power: float) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (W, 40, 15), and measured (W, 40) of steady forces of that power in every axis."""
    slopes = rng.standard_normal((windows, 40, 3 * PIECES))
    force = np.sqrt(power) * rng.standard_normal((windows, 1, 3)).repeat(PIECES, axis=1)
    seen = np.einsum("wmf,wf->wm", slopes, force.reshape(windows, -1))
    return slopes, seen + rng.standard_normal(seen.shape)


def test_the_gain_of_random_forces_is_that_of_the_whole_covariance() -> None:
    slopes, seen = pushed(np.random.default_rng(0), 3, 2.0)
    across = slopes.swapaxes(1, 2)
    made = random_forces(across @ slopes, (across @ seen[..., None])[..., 0], PIECE, 4.0)
    gain = 0.0
    for slope, values in zip(slopes, seen, strict=True):
        covariance = np.eye(len(values)) + slope @ np.linalg.inv(made.prior) @ slope.T
        gain += 2.0 * multivariate_normal(cov=covariance).logpdf(values)
        gain -= 2.0 * multivariate_normal(cov=np.eye(len(values))).logpdf(values)
    assert made.gain == pytest.approx(gain)


def test_the_power_of_forces_is_told() -> None:
    slopes, seen = pushed(np.random.default_rng(1), 400, 9.0)
    across = slopes.swapaxes(1, 2)
    made = random_forces(across @ slopes, (across @ seen[..., None])[..., 0], PIECE, 1000.0)
    assert made.power == pytest.approx(9.0, rel=0.25)


def positions_alone_wander(trials: Trials) -> bool:
    ladder = ladder_of(trials, weights(trials, noise_levels(trials)))
    return wandering(ladder, ladder.fit(MIDDLE, Hypothesis(), np.zeros(0)), MIDDLE) == "receiver"


@pytest.mark.parametrize("outside", [SECTOR, MOORING, DEAD_ZONE], ids=lambda one: one["what"])
def test_a_force_that_is_missing_is_not_taken_for_a_receiver(outside: dict[str, object]) -> None:
    assert not positions_alone_wander(sailed(outside, "B"))


def test_a_receiver_that_wanders_by_less_than_its_noise_is_told_without_velocities() -> None:
    trials = sailed(None, "B")
    errors = wander(np.random.default_rng(3), (5, trials.measured.shape[1], 2), 0.4, 15.0)
    measured = trials.measured.copy()
    measured[..., :2] += errors
    assert positions_alone_wander(replace(trials, measured=measured))
    assert not positions_alone_wander(trials)
