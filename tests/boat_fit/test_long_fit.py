"""The fit of a boat's numbers to long windows, whose weights are those of its own residual."""

from pathlib import Path

import numpy as np

from swamp_rl.boat_fit.fit import fit_boat, long_fit
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from tests.support.hidden_boat import HIDDEN, start_runs

FAR = {  # from the start file, and unstable on course
    "n_r: -0.11": "n_r: -0.3",
    "n_v: -0.09": "n_v: 0.1",
    "quadratic: 6.5": "quadratic: 13.0",
    "quadratic: 7.0": "quadratic: 14.0",
    "effects:": "x_g: 0.2\neffects:",
}


def test_a_fit_from_a_file_far_off_ends_with_the_residuals_of_one_from_the_solution(tmp_path: Path) -> None:
    text = HIDDEN
    for near, far in FAR.items():
        text = text.replace(near, far)
    runs = start_runs(tmp_path, text)
    weight, hypothesis = weights(runs, noise_levels(runs)), free_boat(runs.boat, free_numbers(runs.boat))
    solution = fit_boat(runs, weight, hypothesis, hypothesis.start()).fit.x
    from_file, from_solution = (
        long_fit(runs, weight, hypothesis, x).sigma for x in (hypothesis.start(), solution)
    )
    np.testing.assert_allclose(from_file, from_solution, rtol=0.1)
