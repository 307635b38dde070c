"""Process noise against measurement noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.nuisance.process_noise import random_forces
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from swamp_rl.criticism.selection.model_selection import correlated_noise
from tests.support.criticism import gauss_markov_noise
from tests.support.unmodelled_forces import DEAD_ZONE, MOORING, SECTOR, sailed

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

PIECES, PIECE, CORRELATION_TIME = 5, 1.0, 4.0
SCALE = force_scale(load_boat("swamp"))


def pushed(rng: np.random.Generator, windows: int, power: float) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (W, 40, 15), and measured (W, 40) of Gauss-Markov forces of that power in every axis."""
    slopes = rng.standard_normal((windows, 40, 3 * PIECES))
    apart = np.abs(np.subtract.outer(np.arange(PIECES), np.arange(PIECES))) * PIECE
    root = np.linalg.cholesky(power * np.exp(-apart / CORRELATION_TIME))
    force = root @ rng.standard_normal((windows, PIECES, 3))
    seen = np.einsum("wmf,wf->wm", slopes, force.reshape(windows, -1))
    return slopes, seen + rng.standard_normal(seen.shape)


def test_the_gain_of_random_forces_is_that_of_the_whole_covariance() -> None:
    slopes, seen = pushed(np.random.default_rng(0), 3, 2.0)
    across = slopes.swapaxes(1, 2)
    made = random_forces(across @ slopes, (across @ seen[..., None])[..., 0], PIECE, CORRELATION_TIME, SCALE)
    gain = 0.0
    for slope, values in zip(slopes, seen, strict=True):
        covariance = np.eye(len(values)) + slope @ np.linalg.inv(made.prior) @ slope.T
        gain += 2.0 * multivariate_normal(cov=covariance).logpdf(values)
        gain -= 2.0 * multivariate_normal(cov=np.eye(len(values))).logpdf(values)
    assert made.gain == pytest.approx(gain)


def test_the_power_of_random_forces_is_estimated() -> None:
    slopes, seen = pushed(np.random.default_rng(1), 400, 9.0)
    across = slopes.swapaxes(1, 2)
    made = random_forces(across @ slopes, (across @ seen[..., None])[..., 0], PIECE, CORRELATION_TIME, SCALE)
    assert made.power == pytest.approx(9.0, rel=0.15)


def positions_alone_wander(run_set: RunSet) -> bool:
    continuation = continuation_of(run_set, weights(run_set, noise_levels(run_set)))
    return (
        correlated_noise(continuation, continuation.fit(MIDDLE, Hypothesis(), np.zeros(0)), MIDDLE)
        == "measurement"
    )


@pytest.mark.parametrize("outside", [SECTOR, MOORING, DEAD_ZONE], ids=lambda one: one["what"])
def test_a_missing_force_is_not_taken_for_measurement_noise(outside: dict[str, object]) -> None:
    assert not positions_alone_wander(sailed(outside, "B"))


def test_position_noise_below_the_white_noise_is_found_without_velocities() -> None:
    run_set = sailed(None, "B")
    errors = gauss_markov_noise(np.random.default_rng(3), (5, run_set.measured.shape[1], 2), 0.4, 15.0)
    measured = run_set.measured.copy()
    measured[..., :2] += errors
    assert positions_alone_wander(replace(run_set, measured=measured))
    assert not positions_alone_wander(run_set)
