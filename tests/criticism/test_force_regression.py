"""A force outside the library is attributed to the variable that it is a function of."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.force_regression import (
    MarginalLikelihood,
    held_out_gain,
    marginal_likelihood,
    residual_force_functions,
)
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.nuisance.force_functions import (
    ForceLikelihood,
    Pair,
    force_likelihood,
    functions,
    pairs,
)
from swamp_rl.criticism.nuisance.process_noise import random_forces
from swamp_rl.criticism.options import options
from tests.support.unmodelled_forces import DEAD_ZONE, MOORING, SECTOR, sailed

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

SCALE = force_scale(load_boat("swamp"))
THRUST = float(SCALE[0])
NOTHING = [(Hypothesis(), np.zeros(0))]


@pytest.mark.parametrize(
    ("outside", "level", "expected"),
    [
        (SECTOR, "A", {("surge", "heading")}),
        (SECTOR, "B", {("surge", "heading")}),
        (DEAD_ZONE, "A", {("thrust of ss", "throttle ss")}),
        (DEAD_ZONE, "B", {("thrust of ss", "throttle ss")}),
        (MOORING, "A", {("north", "position north"), ("east", "position east")}),
        (MOORING, "B", {("north", "position north"), ("east", "position east")}),
    ],
)
def test_a_force_outside_the_library_is_attributed_to_its_variable(
    outside: dict[str, Any], level: str, expected: set[tuple[str, str]]
) -> None:
    run_set = sailed(outside, level)
    found = residual_force_functions(run_set, weights(run_set, noise_levels(run_set)), NOTHING)
    assert expected & {(one.force, one.variable) for one in found}, found


def test_a_force_along_an_axis_of_the_earth_is_no_function_of_a_command() -> None:
    run_set = sailed(MOORING, "A")
    weight = weights(run_set, noise_levels(run_set))
    every = pairs(force_likelihood(run_set, weight, *NOTHING[0]))
    of_commands = {one.force for one in every if one.variable.startswith(("throttle", "azimuth"))}
    assert {"surge", "sway", "yaw", "thrust of ss"} <= of_commands
    assert not of_commands & {"north", "east"}


def test_the_estimated_function_is_that_of_the_hidden_force() -> None:
    run_set = sailed(SECTOR, "A")
    found = residual_force_functions(run_set, weights(run_set, noise_levels(run_set)), NOTHING)
    curve = next(one for one in found if (one.force, one.variable) == ("surge", "heading")).curve
    assert [one.at for one in curve] == sorted(one.at for one in curve)
    assert len(curve) == 8
    for point in curve:
        ahead = np.cos(point.at - SECTOR["centre"])
        if abs(ahead) > 0.3:  # straight lines between corners cannot follow the sector's edges
            assert point.force == pytest.approx(SECTOR["force"] * (ahead > 0.0), abs=0.8), curve
        assert 0.0 < point.standard_error < 0.3


@pytest.mark.parametrize("level", ["A", "B"])
def test_no_function_is_found_where_no_force_is_missing(level: str) -> None:
    run_set = sailed(None, level)
    assert residual_force_functions(run_set, weights(run_set, noise_levels(run_set)), NOTHING) == []


@pytest.mark.parametrize(("name", "reach"), [("heading", np.pi), ("azimuth bs", np.pi), ("speed", 1.2)])
def test_functions_of_a_variable_add_up_to_one_and_go_round_an_angle(name: str, reach: float) -> None:
    values = np.linspace(-reach, reach, 200)
    basis = functions(name, values)
    assert basis.sum(axis=-1) == pytest.approx(1.0)
    assert np.allclose(basis[0], basis[-1], atol=1e-9) == (name != "speed")


def test_a_force_in_one_run_alone_is_identified_from_the_rest_of_that_run() -> None:
    rng = np.random.default_rng(5)
    run = np.repeat(np.arange(4), 8)
    design = rng.standard_normal((32, 6, 2)) * (run == 1)[:, None, None]
    information = np.broadcast_to(100.0 * np.eye(6), (32, 6, 6))
    gradient = 100.0 * design @ [1.0, -0.5]
    marginal = MarginalLikelihood(information, gradient, np.ones(3), 0.0)
    pair = Pair("surge", "throttle ss", design, (np.zeros(2),))
    assert held_out_gain(pair, marginal, (run,), THRUST).gain == pytest.approx(0.0, abs=1e-9)
    in_turn = held_out_gain(pair, marginal, (run, np.arange(32) % 8), THRUST)
    assert in_turn.gain > 100.0
    assert in_turn.predicted_force == pytest.approx(design @ [1.0, -0.5], abs=0.05)


def test_the_marginal_likelihood_is_that_of_the_whole_covariance() -> None:
    rng = np.random.default_rng(6)
    slopes, seen = rng.standard_normal((3, 40, 12)), 3.0 * rng.standard_normal((3, 40))
    known = rng.standard_normal((3, 12))
    across = slopes.swapaxes(1, 2)
    information, gradient = across @ slopes, (across @ seen[..., None])[..., 0]
    found = ForceLikelihood(float((seen**2).sum()), information, gradient, (), 10, 0.1, {}, {}, SCALE)
    away = seen - (slopes @ known[..., None])[..., 0]
    marginal = (across @ away[..., None])[..., 0]
    expected = (away**2).sum() - random_forces(
        information, marginal, 1.0, options().regression_time, SCALE
    ).gain
    assert marginal_likelihood(found, known).left == pytest.approx(expected)
