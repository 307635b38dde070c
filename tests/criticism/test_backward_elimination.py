"""Sets of effects less one of them."""

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.model.candidates import by_label, candidates, hull_nuisance, joined
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.backward_elimination import without
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, continuation_of
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

HULL = {"x_vr": 1.1, "y_v": 0.91, "y_r": 0.93, "n_v": 1.03, "n_r": 0.6}


def test_an_effect_whose_part_another_takes_is_dispensable_though_the_fit_to_long_windows_sticks() -> None:
    runs = simulated_runs([{"effect": "hull_coefficients"} | HULL], velocities=False)
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    hull, damping = hull_nuisance(runs.boat), by_label(candidates(runs.boat, SECONDS))["yaw_damping"]
    assert hull is not None
    both = joined([(hull, np.array([1.1, 0.91, 0.93, 1.03, 1.0])), (damping, np.array([HULL["n_r"]]))])
    continuation.fit(0, *both)
    for stage in (MIDDLE, LAST):
        best = continuation.fit(stage, *both)
        with using(fit_steps=1):  # too few for the other number to go all the way
            less = without(continuation, best, "yaw_damping", stage)
        assert less.chi2 < best.chi2 + 20.0
        assert less.x[-1] == pytest.approx(HULL["n_r"], abs=0.01)
