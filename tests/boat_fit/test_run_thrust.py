"""Runs in which the thrusters gave another thrust than in the others."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit.run_thrust import (
    RunThrust,
    ThrustLevel,
    at_level,
    mean_thrust,
    run_thrusts,
    standardised,
    thrust_level,
    unlike,
    with_other_thrust,
    without,
)
from swamp_rl.criticism.data.run_set import read_run_set
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

FOULED = "extends: twin.yaml\nname: fouled\neffects: [{effect: thrust_scale, scale: 0.3}]\n"


def test_the_thrust_of_a_run_is_found_as_a_share_of_the_boats(tmp_path: Path) -> None:
    written(tmp_path, "twin")
    (tmp_path / "fouled.yaml").write_text(FOULED)
    boat = load_boat(tmp_path / "twin.yaml")
    for name, truth in (("clean", boat), ("weed", load_boat(tmp_path / "fouled.yaml"))):
        sailed_dataset(tmp_path / name, tmp_path / "twin.yaml", truth, count=1, seconds=30.0, low=0.0)
        (found,) = run_thrusts(read_run_set(tmp_path / name, boat), boat)
        share = 1.0 if name == "clean" else 0.3
        assert found.name == "run0"
        assert abs(found.share - share) < 4.0 * found.standard_error < 0.2


def test_a_run_that_other_commands_drove_is_distinguished_from_its_like_and_from_a_boat_at_rest(
    tmp_path: Path,
) -> None:
    written(tmp_path, "twin")
    boat = load_boat(tmp_path / "twin.yaml")
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", boat, count=8, seconds=15.0)
    runs = read_run_set(tmp_path / "runs", boat)
    commands, measured = runs.commands.copy(), runs.measured.copy()
    commands[2] = runs.commands[5]  # as logged under a remote control, which drove the boat
    noise = 0.01 * np.random.default_rng(0).standard_normal(measured[7].shape)
    commands[7], measured[7] = 0.0, measured[7, 0] * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0] + noise
    found = unlike(run_thrusts(replace(runs, commands=commands, measured=measured), boat))
    assert [one.name for one in found.commands] == ["run2"]
    assert found.thrust == ()


def shares(*values: float, error: float = 0.05) -> list[RunThrust]:
    return [RunThrust(f"run{k}", value, error) for k, value in enumerate(values)]


def test_a_run_far_from_the_others_has_another_thrust_and_one_within_their_spread_has_not() -> None:
    alike = (0.9, 1.1, 1.0, 1.2, 0.85, 1.05, 0.95)
    assert with_other_thrust(shares(*alike)) == []
    (found,) = with_other_thrust(shares(*alike, 0.3))
    assert found.name == "run7"
    assert with_other_thrust(shares(1.0, 0.4, 2.1, 0.7, 1.5, 0.5, 3.0, 0.3)) == []


def test_a_run_that_shows_little_of_its_thrust_is_not_distinguished_from_the_others() -> None:
    known = shares(0.9, 1.1, 1.0, 1.2, 0.85, 1.05, 0.95)
    assert with_other_thrust([*known, RunThrust("adrift", 0.3, 0.8)]) == []


def test_of_few_runs_none_is_judged() -> None:
    assert with_other_thrust(shares(1.0, 1.0, 1.0, 1.0, 0.1)) == []


def test_alike_runs_are_taken_for_another_as_seldom_as_stated() -> None:
    rng = np.random.default_rng(3)
    drawn = [np.exp(rng.normal(0.0, np.hypot(0.25, 0.05), 30)) for _ in range(40)]
    wrong = sum(bool(with_other_thrust(shares(*one))) for one in drawn)
    assert wrong <= 2  # a binomial count with mean 0.4 is larger once in 120 times


@pytest.mark.parametrize("spread", [0.2, 0.5])
def test_the_spread_between_runs_is_found_beside_the_errors_of_the_runs(spread: float) -> None:
    rng = np.random.default_rng(1)
    errors = rng.uniform(0.02, 0.3, 4000)
    _, found = standardised(rng.normal(0.0, np.hypot(spread, errors)), errors)
    assert found == pytest.approx(spread, rel=0.1)


def test_the_mean_thrust_of_runs_is_within_its_error_as_often_as_stated() -> None:
    rng = np.random.default_rng(2)
    errors = rng.uniform(0.01, 0.2, 12)
    away = []
    for _ in range(60):
        drawn = rng.normal(0.9, np.hypot(0.12, errors))
        mean = mean_thrust([RunThrust("", *one) for one in zip(drawn, errors, strict=True)])
        away.append((mean.mean - 0.9) / mean.standard_error)
    assert np.mean(np.abs(away) < 1.96) > 0.87  # 95 % of 60, less three standard deviations
    assert mean_thrust(shares(0.8, 0.9, 1.0)).mean == pytest.approx(0.9)


def test_the_level_of_the_thrust_is_the_mean_of_the_runs_only_where_it_differs() -> None:
    low = (0.9, 0.85, 0.88, 0.95, 0.82, 0.91)
    assert thrust_level(shares(*low)).mean == pytest.approx(np.mean(low))
    for unclear in ((0.7, 1.3, 0.9, 1.2, 0.8, 1.0), (0.5,), ()):
        assert thrust_level(shares(*unclear)) == ThrustLevel()


def test_shares_are_those_of_the_boat_at_the_level() -> None:
    (found,) = at_level(shares(0.45, error=0.09), ThrustLevel(0.9, 0.02))
    assert (found.share, found.standard_error) == pytest.approx((0.5, 0.1))


def test_runs_are_left_out_by_name(tmp_path: Path) -> None:
    written(tmp_path, "twin")
    boat = load_boat(tmp_path / "twin.yaml")
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", boat, count=3, seconds=12.0)
    runs = read_run_set(tmp_path / "runs", boat)
    assert without(runs, {"run1"}).names == ("run0", "run2")
    assert without(runs, set()) is runs
