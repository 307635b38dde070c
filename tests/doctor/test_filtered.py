"""The spectrum of a filter's output and that of an error that wanders, which no channel tells apart."""

import numpy as np
import pytest

from swamp_rl.doctor.filtered import filter_findings, power_drop
from swamp_rl.runs import Run
from tests.support.doctored import STEP, gauss_markov


def test_an_error_that_wanders_has_the_drop_of_its_spectrum_and_is_not_called_smoothed_alone() -> None:
    rng = np.random.default_rng(3)
    time = STEP * np.arange(6001)
    north = 0.5 * time + gauss_markov(rng, 6001, 0.3, 20.0)
    keep, low, high = np.exp(-STEP / 20.0), 0.425 * np.pi, 0.925 * np.pi
    density = [1.0 / (1.0 + keep**2 - 2.0 * keep * np.cos(one)) for one in (low, high)]
    assert power_drop([north]) == pytest.approx(density[0] / density[1], rel=0.15)
    (found,) = filter_findings([Run("run", {"time": time, "north": north})], measured=True)
    assert "smoothed them, or the receiver's error wanders" in found.advice


def test_an_error_that_wanders_less_from_row_to_row_than_its_white_noise_has_a_floor() -> None:
    rng = np.random.default_rng(3)
    north = gauss_markov(rng, 6001, 0.3, 20.0) + 0.05 * rng.standard_normal(6001)
    assert power_drop([north]) is None
