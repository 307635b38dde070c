"""Causes tested beside errors of the model's curves: an error that repeats with a manoeuvre is no weather."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.likelihood.cross_validation import Confirmation
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.nuisance.curve_errors import beside_curve_errors, marginal, most_likely, quadratic
from swamp_rl.criticism.nuisance.force_functions import ForceLikelihood
from swamp_rl.criticism.nuisance.process_noise import model_error
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.stepwise_selection import RatioTests
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

SCALE = force_scale(load_boat("swamp"))
# each thruster's thrust is wrong by its own curve, the hull's forces by theirs
CURVES: list[dict[str, Any]] = [
    {"effect": "thruster_efficiency_curve", "thruster": name, "at_30": 1 + a, "at_60": 1 - a, "at_100": 1 + b}
    for name, a, b in (("bs", 0.04, -0.03), ("bp", -0.05, 0.02), ("ss", 0.03, 0.05), ("sp", -0.02, -0.04))
] + [{"effect": "resistance", "scale": 1.05}, {"effect": "yaw_damping", "scale": 0.93}]
WIND = {"effect": "wind", "speed": 4.0, "from": 0.5}


def fitted(found: RunSet, weight: np.ndarray, label: str) -> Fit:
    """One effect, or none, fitted to windows of 20 s."""
    every = by_label(candidates(found.boat, SECONDS, found.groups))
    instances = (every[label],) if label else ()
    problem = Shooting(found, weight, 20.0)
    start = np.tile([1.0, 1.0], 3) if label else np.zeros(0)
    return fit(problem, Hypothesis(instances), start, problem.initial_states())


def test_curves_in_error_are_no_wind_of_each_run_and_a_wind_is_one() -> None:
    for effects, there in ((CURVES, False), ([*CURVES, WIND], True)):
        found = simulated_runs(effects)
        weight = weights(found, noise_levels(found))
        tests = RatioTests(found, weight, 72, alone=True)
        whole, less = fitted(found, weight, "wind by_run"), fitted(found, weight, "")
        assert less.chi2 - whole.chi2 > 200.0  # under white noise a wind is found in any case
        assert tests.find(whole, less) is there


def test_errors_of_curves_that_all_runs_share_widen_the_standard_error() -> None:
    variances = []
    for effects in (CURVES, [{"effect": "resistance", "scale": 1.05}]):
        found = simulated_runs(effects)
        weight = weights(found, noise_levels(found))
        instance = by_label(candidates(found.boat, SECONDS))["resistance"]
        weighted = model_error(found, weight, Hypothesis((instance,)), np.array([1.0]), 10.0)
        between_runs = sandwich_covariance(weighted.problem, weighted.fit)[0, 0]
        weighted.problem.least_variances = RatioTests(found, weight, 72).parameter_variances
        variances.append(weighted.problem.least_variances(weighted.fit)[0])
        both = sandwich_covariance(weighted.problem, weighted.fit)[0, 0]
        assert both == pytest.approx(max(between_runs, variances[-1]))
        assert abs(weighted.fit.x[0] - 1.05) < 2.0 * np.sqrt(both)
    assert variances[0] > 4.0 * variances[1]


def test_a_gain_on_held_out_windows_is_no_cause_without_a_significant_likelihood_ratio() -> None:
    assert Confirmation(gain=90.0, low=40.0, level=0.99).holds
    assert not Confirmation(gain=90.0, low=40.0, level=0.99, significant=False).holds
    assert Confirmation(gain=9.0, low=-4.0, level=0.99, significant=True).holds
    assert not Confirmation(gain=-1.0, low=-4.0, level=0.99, significant=True).holds


def likelihood(rng: np.random.Generator) -> tuple[ForceLikelihood, np.ndarray, np.ndarray, np.ndarray]:
    """Of three windows of 40 residuals, two parameters and four intervals; and what it was computed from."""
    slopes, seen = rng.standard_normal((3, 40, 14)), 3.0 * rng.standard_normal((3, 40))
    across = slopes.swapaxes(1, 2)
    information, gradient = across @ slopes, (across @ seen[..., None])[..., 0]
    chi2 = float((seen**2).sum())
    found = ForceLikelihood(chi2, information, gradient, (), 10, 0.1, {}, {}, SCALE, 2)
    return found, seen, slopes, rng.standard_normal((3, 12, 5))


def test_the_deviance_is_that_of_the_whole_covariance_at_the_best_parameters() -> None:
    found, seen, slopes, curves = likelihood(np.random.default_rng(3))
    variances = np.array([0.2, 0.5, 0.1, 0.3])
    times = np.abs(np.subtract.outer(np.arange(4), np.arange(4))) / options().regression_time
    each = np.kron(np.exp(-times), np.diag(variances[:3]))
    steps, forces = slopes[..., :2].reshape(120, 2), slopes[..., 2:]
    by_weights = (forces @ curves).reshape(120, 5)
    covariance = np.eye(120) + variances[3] * by_weights @ by_weights.T
    for window in range(3):
        rows = slice(40 * window, 40 * window + 40)
        covariance[rows, rows] += forces[window] @ each @ forces[window].T
    inverse = np.linalg.inv(covariance)
    best = np.linalg.solve(steps.T @ inverse @ steps, steps.T @ inverse @ seen.ravel())
    left = seen.ravel() - steps @ best
    expected = left @ inverse @ left + np.linalg.slogdet(covariance)[1]
    at = marginal(quadratic(found, curves, np.zeros(2), np.zeros(2)), variances)
    assert at.deviance == pytest.approx(expected)
    of_parameters = np.linalg.inv(steps.T @ inverse @ steps)
    assert at.parameter_variances == pytest.approx(np.diag(of_parameters))


def test_the_gradient_is_that_of_the_deviance_by_the_logarithms_of_the_variances() -> None:
    found, _, _, curves = likelihood(np.random.default_rng(5))
    of = quadratic(found, curves, np.array([0.3, -0.2]), np.array([2.0, 0.0]))
    log, step = np.log([0.2, 0.5, 0.1, 0.3]), 1e-4 * np.eye(4)
    ahead, behind = ([marginal(of, np.exp(log + s * one)).deviance for one in step] for s in (1, -1))
    slope = (np.array(ahead) - behind) / 2e-4
    assert marginal(of, np.exp(log)).gradient == pytest.approx(slope, rel=1e-5, abs=1e-5)


def test_at_the_variances_found_the_likelihood_is_greatest() -> None:
    found, _, _, curves = likelihood(np.random.default_rng(4))
    of = quadratic(found, curves, np.zeros(2), np.zeros(2))
    force, weight = options().curve_errors_begin
    begin = marginal(of, np.append(force * SCALE, weight) ** 2)
    best = most_likely(of, SCALE)
    assert best.deviance < begin.deviance - 10.0
    assert np.abs(best.gradient).max() < 0.01 * np.abs(begin.gradient).max()


def test_the_deviance_falls_by_far_more_than_its_charge_where_the_wind_is_put_in() -> None:
    found = simulated_runs([*CURVES, WIND])
    weight = weights(found, noise_levels(found))
    wind = by_label(candidates(found.boat, SECONDS))["wind"]
    calm = beside_curve_errors(found, weight, Hypothesis(), np.zeros(0)).deviance
    towards = 4.0 * np.array([np.cos(0.5), np.sin(0.5)])
    assert beside_curve_errors(found, weight, Hypothesis((wind,)), towards).deviance < calm - 50.0
