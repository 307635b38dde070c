"""The fit of a boat's numbers to long windows, whose weights are those of its own residual."""

from pathlib import Path

import numpy as np

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit.fit import fit_boat, long_fit
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import read_run_set
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

UNSTABLE = """extends: twin.yaml
name: unstable
x_g: 0.2
added_mass_sway: -10.0
hull: {n_r: -0.3, c_d: 1.3, n_v: 0.1}
resistance: {x_0_ahead: -0.09}
thrusters:
  port: {thrust_quadratic: 13.0, pump_time_constant: 0.3}
  starboard: {thrust_quadratic: 14.0, pump_time_constant: 0.3}
effects:
  - {effect: throttle_dead_band, thruster: all, below: 0.1}
"""


def test_a_fit_from_a_file_far_off_ends_with_the_residuals_of_one_from_the_solution(tmp_path: Path) -> None:
    start = written(tmp_path, "twin")
    (tmp_path / "unstable.yaml").write_text(UNSTABLE)
    sailed_dataset(tmp_path / "runs", start, load_boat(tmp_path / "unstable.yaml"))
    runs = read_run_set(tmp_path / "runs", load_boat(start))
    weight, hypothesis = weights(runs, noise_levels(runs)), free_boat(runs.boat, free_numbers(runs.boat))
    solution = fit_boat(runs, weight, hypothesis, hypothesis.start()).fit.x
    far, near = (long_fit(runs, weight, hypothesis, x).sigma for x in (hypothesis.start(), solution))
    np.testing.assert_allclose(far, near, rtol=0.1)
