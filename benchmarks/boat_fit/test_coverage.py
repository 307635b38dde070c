"""Fits of synthetic boats."""

import numpy as np

from benchmarks.boat_fit.coverage import RUNS, drawn_boat, sailed
from swamp_rl.boat_fit.fit import fit_boat
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.one_thread import one_thread

CURVED = (  # fields of numbers whose likelihood has a long curved ridge
    "thrust_linear",
    "thrust_quadratic",
    "dead_band",
    "efficiency_100",
    "pump_time_constant",
    "command_delay",
    "c_ry",
    "c_rn",
    "c_d",
)


@one_thread()
def test_gusts_do_not_carry_a_fit_along_the_ridge_of_thrust_and_dead_band() -> None:
    _, boat, plain, truth, _ = drawn_boat(25, 7)
    mine = [i for i, number in enumerate(plain.numbers) if number.field in CURVED]
    numbers, truth = tuple(plain.numbers[i] for i in mine), truth[mine]
    runs = sailed(free_boat(boat, numbers), boat, truth, True, np.random.default_rng(0))
    hypothesis = free_boat(boat, numbers, RUNS, ("wind",))
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    errors = np.sqrt(np.diag(made.covariance))[: len(truth)]
    assert np.abs((made.fit.x[: len(truth)] - truth) / errors).max() < 3.0
