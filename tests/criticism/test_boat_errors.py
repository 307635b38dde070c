"""Errors of the boat file's own fitted numbers in the errors of an effect's parameters."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.boat import Boat
from swamp_rl.boat.covariance import Covariance
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.boat_errors import beside_boat_errors, boat_file_covariance
from swamp_rl.criticism.inference.cause_share import list_causes
from swamp_rl.criticism.inference.sandwich_covariance import covariance_of_data, sandwich_covariance
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.backward_elimination import Selection
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = pytest.mark.numerical

GAIN = 0.8
RUNS = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": GAIN}])
WINDOW = 10.0  # s


def with_errors(boat: Boat, correlation: float = 0.0, **errors: float) -> Boat:
    """The boat with errors of numbers, all pairs of one correlation."""
    rows = tuple((correlation,) * i for i in range(len(errors)))
    known = Covariance(
        source="runs",
        numbers=tuple(errors),
        standard_errors=tuple(errors.values()),
        correlation=rows,
    )
    return boat.model_copy(update={"covariance": known})


def required(others: Hypothesis, own: EffectInstance) -> float:
    """As for an effect that was sought."""
    return 4.0


def fitted(runs: RunSet) -> tuple[Shooting, Fit]:
    """The thruster's gain on windows."""
    problem = Shooting(runs, weights(runs, noise_levels(runs)), WINDOW)
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))["thruster_gain bs"],))
    return problem, fit(problem, hypothesis, np.array([GAIN]), problem.initial_states(), fresh=True)


def errors_of_gain(**given: float) -> float:
    """Standard deviation of the gain by errors of the boat file."""
    problem, at = fitted(replace(RUNS, boat=with_errors(RUNS.boat, **given)))
    return float(boat_file_covariance(problem, at)[0, 0] ** 0.5)


def test_the_error_of_an_estimate_by_that_of_the_mass_is_what_a_fit_with_another_mass_differs_by() -> None:
    heavier = RUNS.boat.model_copy(update={"mass": RUNS.boat.mass * np.exp(0.01)})
    differ = [fitted(replace(RUNS, boat=boat))[1].x[0] for boat in (RUNS.boat, heavier)]
    assert errors_of_gain(mass=0.01) == pytest.approx(abs(differ[1] - differ[0]), rel=0.05)


def test_errors_that_are_correlated_add_and_subtract() -> None:
    alone = errors_of_gain(mass=0.01), errors_of_gain(inertia_z=0.02)
    both = {"mass": 0.01, "inertia_z": 0.02}
    together = [errors_of_gain(correlation=sign, **both) for sign in (1.0, 0.0, -1.0)]
    assert together[1] == pytest.approx(np.hypot(*alone), rel=0.02)
    assert sorted(together[::2]) == pytest.approx([abs(alone[0] - alone[1]), sum(alone)], rel=0.02)


def test_a_boat_file_without_errors_adds_none() -> None:
    problem, at = fitted(RUNS)
    assert np.array_equal(sandwich_covariance(problem, at), covariance_of_data(problem, at))


def test_an_effect_within_the_errors_of_the_boat_file_is_no_cause() -> None:
    curve = RUNS.boat.thrusters[0].thrust_curve(RUNS.boat.water_density)
    names = [f"thrusters.bs.thrust_{power}" for power in ("linear", "quadratic")]
    for share, minor in ((0.01, False), (0.2, True)):
        errors = {name: share * size for name, size in zip(names, curve, strict=True)}
        problem, at = fitted(replace(RUNS, boat=with_errors(RUNS.boat, 1.0, **errors)))
        beside = beside_boat_errors(problem, at, required)
        found = list_causes(problem, Selection(at, True, 1, [], [], [], []), {}, [], {}, beside.within)
        assert beside.adequate and bool(found.minor) is minor is not bool(found.causes)
        assert all(one.within_boat_errors for one in found.minor)


def test_runs_that_the_errors_of_the_boat_file_explain_leave_noise() -> None:
    """The hidden gain of one thruster, as the file's numbers would have it."""
    nothing = Hypothesis()
    for share, enough in ((0.01, False), (0.2, True)):
        curve = RUNS.boat.thrusters[0].thrust_curve(RUNS.boat.water_density)
        errors = {
            f"thrusters.bs.thrust_{p}": share * s for p, s in zip(("linear", "quadratic"), curve, strict=True)
        }
        boat = with_errors(RUNS.boat, 1.0, **errors)
        problem = Shooting(replace(RUNS, boat=boat), weights(RUNS, noise_levels(RUNS)), 3.0)
        at = fit(problem, nothing, np.zeros(0), problem.initial_states())
        assert not adequacy(problem, at).adequate
        assert beside_boat_errors(problem, at, required).adequate is enough
