"""A force that no effect of the library makes is told by what it goes with."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.pointing import (
    LASTING,
    Pair,
    Remainder,
    Responses,
    functions,
    leftovers,
    remainder,
    saved,
)
from swamp_rl.criticism.unsteady import random_forces
from tests.support.unmodelled_forces import DEAD_ZONE, MOORING, SECTOR, sailed

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

NOTHING = [(Hypothesis(), np.zeros(0))]


@pytest.mark.parametrize(
    ("outside", "level", "pairs"),
    [
        (SECTOR, "A", {("surge", "heading")}),
        (SECTOR, "B", {("surge", "heading")}),
        (DEAD_ZONE, "A", {("thrust of ss", "throttle ss")}),
        (DEAD_ZONE, "B", {("thrust of ss", "throttle ss")}),
        (MOORING, "A", {("north", "position north"), ("east", "position east")}),
        (MOORING, "B", {("north", "position north"), ("east", "position east")}),
    ],
)
def test_what_no_effect_makes_is_told_by_what_it_goes_with(
    outside: dict[str, Any], level: str, pairs: set[tuple[str, str]]
) -> None:
    trials = sailed(outside, level)
    found = leftovers(trials, weights(trials, noise_levels(trials)), NOTHING)
    assert pairs & {(one.force, one.variable) for one in found}, found


def test_the_shape_of_what_is_missing_is_that_of_the_hidden_force() -> None:
    trials = sailed(SECTOR, "A")
    found = leftovers(trials, weights(trials, noise_levels(trials)), NOTHING)
    curve = next(one for one in found if (one.force, one.variable) == ("surge", "heading")).curve
    assert [one.at for one in curve] == sorted(one.at for one in curve)
    assert len(curve) == 8
    for point in curve:
        ahead = np.cos(point.at - SECTOR["centre"])
        if abs(ahead) > 0.3:  # straight lines between corners cannot follow the sector's edges
            assert point.force == pytest.approx(SECTOR["force"] * (ahead > 0.0), abs=0.8), curve
        assert 0.0 < point.standard_error < 0.3


@pytest.mark.parametrize("level", ["A", "B"])
def test_where_nothing_is_missing_nothing_is_pointed_at(level: str) -> None:
    trials = sailed(None, level)
    assert leftovers(trials, weights(trials, noise_levels(trials)), NOTHING) == []


@pytest.mark.parametrize(("name", "reach"), [("heading", np.pi), ("azimuth bs", np.pi), ("speed", 1.2)])
def test_functions_of_a_variable_add_up_to_one_and_go_round_an_angle(name: str, reach: float) -> None:
    values = np.linspace(-reach, reach, 200)
    basis = functions(name, values)
    assert basis.sum(axis=-1) == pytest.approx(1.0)
    assert np.allclose(basis[0], basis[-1], atol=1e-9) == (name != "speed")


def test_what_acts_in_one_run_alone_is_learnt_from_the_rest_of_it() -> None:
    rng = np.random.default_rng(5)
    run = np.repeat(np.arange(4), 8)
    design = rng.standard_normal((32, 6, 2)) * (run == 1)[:, None, None]
    information = np.broadcast_to(100.0 * np.eye(6), (32, 6, 6))
    gradient = 100.0 * design @ [1.0, -0.5]
    rest = Remainder(information, gradient, np.ones(3), 0.0)
    pair = Pair("surge", "throttle ss", design, (np.zeros(2),))
    assert saved(pair, rest, (run,)).gain == pytest.approx(0.0, abs=1e-9)
    in_turn = saved(pair, rest, (run, np.arange(32) % 8))
    assert in_turn.gain > 100.0
    assert in_turn.foretold == pytest.approx(design @ [1.0, -0.5], abs=0.05)


def test_what_is_left_is_what_the_forces_and_random_ones_do_not_explain() -> None:
    rng = np.random.default_rng(6)
    slopes, seen = rng.standard_normal((3, 40, 12)), 3.0 * rng.standard_normal((3, 40))
    known = rng.standard_normal((3, 12))
    across = slopes.swapaxes(1, 2)
    information, gradient = across @ slopes, (across @ seen[..., None])[..., 0]
    found = Responses(float((seen**2).sum()), information, gradient, (), 10, 0.1, {}, {})
    away = seen - (slopes @ known[..., None])[..., 0]
    rest = (across @ away[..., None])[..., 0]
    expected = (away**2).sum() - random_forces(information, rest, 1.0, LASTING).gain
    assert remainder(found, known).left == pytest.approx(expected)
