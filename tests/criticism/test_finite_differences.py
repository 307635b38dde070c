"""Jacobians by finite differences of simulations."""

import math

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian, state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


@pytest.mark.parametrize(
    ("effect", "x"), [("mass", [56.0]), ("command_delay", [0.3]), ("position_lever_arm", [0.2, -0.1])]
)
def test_jacobians_of_whole_runs_are_those_of_their_finer_steps_with_less_simulated(
    effect: str, x: list[float]
) -> None:
    runs = simulated_runs([{"effect": "resistance", "scale": 1.2}])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), math.inf)
    finer = problem.integrated_in(problem.substeps)
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))[effect],))
    where = hypothesis, np.array(x), problem.initial_states()
    made = []
    for one in (problem, finer):
        base, before = one.track(*where), one.boat_steps[0]
        slopes = state_jacobian(one, *where, base), parameter_jacobian(one, *where, base)
        made.append((*slopes, one.boat_steps[0] - before))
    (by_state, by_x, steps), (state_of_finer, x_of_finer, steps_of_finer) = made
    assert np.linalg.norm(by_state - state_of_finer) < 2e-3 * np.linalg.norm(state_of_finer)
    assert np.linalg.norm(by_x - x_of_finer) < 2e-3 * np.linalg.norm(x_of_finer)
    assert steps < 0.85 * steps_of_finer


def test_jacobians_are_finite_where_whole_runs_diverge_in_the_simulators_own_steps() -> None:
    """As of a fit whose clock is a third of a second off: it begins with velocities that no boat has."""
    runs = simulated_runs([{"effect": "resistance", "scale": 1.2}])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), math.inf)
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))["clock_offset"],))
    states = problem.initial_states()
    states[:, 3:] = 13.8, -9.2, 3.1
    where = hypothesis, np.array([-0.35]), states
    base, own = problem.track(*where), problem.integrated_in(problem.jacobian_substeps).track(*where)
    assert np.isfinite(base).all() and not np.isfinite(own).all()
    assert np.isfinite(state_jacobian(problem, *where, base)).all()
    assert np.isfinite(parameter_jacobian(problem, *where, base)).all()
