"""Responses to short forces from state transitions, against simulations with those forces."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.force_sensitivity import force_grid, force_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.frequency_scan import wave_starts
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

FORCE = np.array([1e-3, 1e-3, 1e-3])  # N, N, N m


@pytest.fixture(scope="module")
def runs() -> Any:
    return simulated_runs([])


@pytest.mark.parametrize(
    ("effect", "values", "seconds"),
    [
        (None, (), 5.0),
        (None, (), np.inf),
        ("mass", (65.0,), 20.0),
        ("position_lever_arm", (0.3, -0.2), 20.0),
        ("clock_offset", (-0.23,), 20.0),
        ("heading_bias", (0.1,), 20.0),
        ("command_delay", (0.35,), 20.0),
    ],
)
def test_a_short_force_moves_what_is_measured_as_a_simulation_with_it_says(
    runs: Any, effect: str | None, values: tuple[float, ...], seconds: float
) -> None:
    problem = Shooting(runs, weights(runs, noise_levels(runs)), seconds)
    known = by_label(candidates(load_boat("swamp"), SECONDS))
    hypothesis = Hypothesis((known[effect],) if effect else ())
    where = hypothesis, np.array(values), problem.initial_states()
    grid = force_grid(problem, 0.5)
    acting = np.random.default_rng(1).normal(0.0, 0.3, (problem.windows.count, grid.count, 3))
    slopes = force_jacobian(problem, *where, grid, (0, 1, 2), acting)

    def simulated(force: Any) -> Any:
        given = where[0], where[1][None], where[2][None], force / grid.inertia, grid.block
        return problem.predict(*given)[0]

    for block in (0, 3, len(acting[0]) - 2):
        for axis in range(3):
            more, less = acting.copy(), acting.copy()
            more[:, block, axis] += FORCE[axis]
            less[:, block, axis] -= FORCE[axis]
            change = (simulated(more) - simulated(less)) / (2.0 * FORCE[axis])
            expected = problem.standardised(change)
            found = slopes[..., 3 * block + axis]
            assert found == pytest.approx(expected, rel=0.0, abs=2e-3 * np.abs(expected).max() + 1e-9)


def test_both_ways_to_scan_frequencies_find_the_same_waves() -> None:
    found = simulated_runs([{"effect": "waves", "force": 0.4, "frequency": 0.23, "from": 1.0}], seed=8)
    problem = Shooting(found, weights(found, noise_levels(found)), 20.0)
    mass = by_label(candidates(load_boat("swamp"), SECONDS))["mass"]
    hypothesis = Hypothesis((mass,))
    at = fit(problem, hypothesis, np.array([60.0]), problem.initial_states())
    by_x = parameter_jacobian(
        problem, hypothesis, at.x, at.states, problem.track(hypothesis, at.x, at.states)
    )
    with using(wave_pulses=0):
        each = wave_starts(problem, at, by_x)
    with using(wave_pulses=1000):
        pulses = wave_starts(problem, at, by_x)
    assert np.array(each) == pytest.approx(np.array(pulses), rel=1e-5, abs=1e-6)
