"""The error of the integration is no cause: it counts as noise of the measurement."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.likelihood.discretisation import discretisation_errors
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.substeps import substeps_of
from tests.support.criticism import DT, SIGMA, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def small_boat_without_noise(folder: Path, seed: int, hold: int, throttles: list[float]) -> RunSet:
    """Two runs of 13 s of a boat of 0.4 m, simulated with its own step, under throttles that are held for
    so many rows.
    """
    path = folder / "tiny.yaml"
    path.write_text(annotated(boat_file("tiny", "twin-fixed", 0.4, 0.25, 2.0, 4.0), "# A small boat."))
    boat, record = load_boat(path), parameters(load_boat(path), 2)
    levels = np.random.default_rng(seed).choice(throttles, (2, 130 // hold, 2))
    commands = np.concatenate([np.zeros((2, 130, 2)), np.repeat(levels, hold, axis=1)], axis=2)
    start, seeds = initial_state(record, np.zeros((2, 3))), np.zeros(2, np.uint64)
    track = simulate(record, tank(boat), start, commands[:, :-1].copy(), seeds, DT, substeps_of(DT, boat))
    return RunSet(boat, DT, ("a", "b"), commands, observe(track, record, DT), np.full(2, 130))


@pytest.mark.parametrize(
    ("seed", "hold", "throttles"), [(2, 10, [0.0, 1.0, 1.0]), (1, 5, [-1.0, 0.0, 1.0, 1.0])]
)
def test_runs_of_a_small_boat_without_noise_are_clean(
    tmp_path: Path, seed: int, hold: int, throttles: list[float]
) -> None:
    """Both were accused of an uneven thruster while whole runs were held to be exact."""
    runs = small_boat_without_noise(tmp_path, seed, hold, throttles)
    found = examine(runs, None, np.random.default_rng(0)).diagnosis
    assert (found.verdict, found.causes, found.indistinguishable) == ("nothing_wrong", [], [])


def test_the_error_of_the_integration_is_far_below_the_noise_of_a_receiver() -> None:
    runs = simulated_runs([])
    errors = discretisation_errors(runs, weights(runs, noise_levels(runs)))
    assert (errors > 0.0).all()
    assert (errors < 0.2 * np.broadcast_to(SIGMA, 6)).all()


def test_a_heading_half_a_turn_from_the_boat_file_has_no_larger_error() -> None:
    """Its residual wraps round, with one step at other samples than with another."""
    runs = simulated_runs([])
    weight = weights(runs, noise_levels(runs))
    problem = Shooting(runs, weight, math.inf)
    fine = problem.track(Hypothesis(), np.zeros(0), problem.initial_states())
    measured, first = runs.measured.copy(), runs.measured.shape[1] - fine.shape[1] + 100
    measured[:, first:, 2] = fine[:, 100:, 2] + np.pi
    errors = discretisation_errors(replace(runs, measured=measured), weight)
    assert (errors < 0.2 * np.broadcast_to(SIGMA, 6)).all()
