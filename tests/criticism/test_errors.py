"""Standard errors of the parameters."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.cause_share import list_causes
from swamp_rl.criticism.inference.estimate import causes_of, sides_of
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance, variances_between_runs
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.nuisance.process_noise import model_error
from swamp_rl.criticism.selection.backward_elimination import Selection
from tests.support.criticism import SECONDS, joined, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


@pytest.fixture(scope="module")
def fitted() -> tuple[Shooting, Fit]:
    """A thruster's gain on whole runs."""
    found = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.8}])
    problem = Shooting(found, weights(found, noise_levels(found)), np.inf)
    instance = by_label(candidates(found.boat, SECONDS))["thruster_gain bs"]
    return problem, fit(
        problem, Hypothesis((instance,)), np.array([0.8]), problem.initial_states(), fresh=True
    )


def test_standard_errors_of_white_residuals_are_those_of_the_information(
    fitted: tuple[Shooting, Fit],
) -> None:
    problem, at = fitted
    ratio = np.sqrt(sandwich_covariance(problem, at)[0, 0] / at.covariance[0, 0])
    assert 1.0 <= ratio < 1.5


def test_correlated_residuals_widen_standard_errors(fitted: tuple[Shooting, Fit]) -> None:
    problem, at = fitted
    smooth = at.residual.reshape(problem.windows.count, -1, 6)
    held = np.repeat(smooth[:, ::10], 10, axis=1)[:, : smooth.shape[1]].reshape(at.residual.shape)
    ratio = np.sqrt(sandwich_covariance(problem, replace(at, residual=held))[0, 0] / at.covariance[0, 0])
    assert ratio > 2.0


@pytest.mark.parametrize(("gains", "least", "most"), [((0.7, 0.9), 0.04, 0.12), ((0.8, 0.8), 0.0, 0.01)])
def test_a_model_error_that_differs_between_runs_widens_standard_errors(
    gains: tuple[float, float], least: float, most: float
) -> None:
    """Three runs of each gain: their mean has a standard error of 0.1 over the root of five."""
    first, more = (
        simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": gain}]) for gain in gains
    )
    found = joined(first, more)
    instance = by_label(candidates(found.boat, SECONDS))["thruster_gain bs"]
    weight = weights(found, noise_levels(found))
    weighted = model_error(found, weight, Hypothesis((instance,)), np.array([0.8]), 10.0)
    (error,) = np.sqrt(variances_between_runs(weighted.problem, weighted.fit))
    assert least < error < most
    assert sandwich_covariance(weighted.problem, weighted.fit)[0, 0] >= 0.999 * error**2


def test_a_cause_without_a_finite_standard_error_is_not_claimed(fitted: tuple[Shooting, Fit]) -> None:
    problem, at = fitted
    endless = replace(at.normal, information=np.full_like(at.normal.information, np.inf))
    search = Selection(replace(at, normal=endless), True, 2, [], [], [], [])
    refused = list_causes(problem, search, {}, [], {})
    assert (refused.causes, refused.sound) == ([], False)
    claimed = list_causes(problem, replace(search, winner=at), {}, [], {})
    assert claimed.sound
    assert [cause.effect for cause in claimed.causes] == ["thruster_gain"]


@pytest.mark.parametrize(("value", "limit"), [(0.0, "at_most"), (2.5, "at_least"), (0.8, None)])
def test_a_parameter_at_a_bound_is_marked(
    fitted: tuple[Shooting, Fit], value: float, limit: str | None
) -> None:
    problem, at = fitted
    estimate = causes_of(problem, replace(at, x=np.array([value])))[0].parameters["gain"]
    assert (estimate.value, estimate.at_bound, estimate.limit) == (value, limit is not None, limit)


def test_one_component_of_the_wind_is_at_a_bound() -> None:
    wind = by_label(candidates(load_boat("swamp"), SECONDS))["wind"]
    assert list(sides_of(wind, np.array([-20.0, 3.0]))) == [-1.0, 0.0]
    assert not sides_of(wind, np.array([-19.9, 20.1 - 0.2])).any()
