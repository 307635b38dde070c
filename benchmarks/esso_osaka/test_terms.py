"""The terms that are compared on the pond, and the table of diagnoses."""

import math

import numpy as np
import pytest

from benchmarks.esso_osaka.answers import held, winds_held
from benchmarks.esso_osaka.rudder import tried, with_force
from benchmarks.esso_osaka.terms import TERMS, boat_with, halves
from swamp_rl.boat import load_boat
from swamp_rl.criticism.result import Cause, Estimate
from swamp_rl.runs import Run
from swamp_rl.simulator import parameters

BOAT = load_boat("esso_osaka")


def blown(name: str, speed: float, angle: float) -> Run:
    rows = np.arange(5) * 1.0
    columns = {"time": rows, "wind_speed": np.full(5, speed), "wind_from": np.full(5, angle)}
    return Run(name, columns)


def wind(speed: float, angle: float) -> dict[str, Estimate]:
    values = {"speed": (speed, "m/s"), "from": (angle, "rad")}
    return {
        name: Estimate(value=value, standard_error=0.1, unit=unit) for name, (value, unit) in values.items()
    }


def test_a_number_is_a_multiple_of_the_boat_files_or_added_where_that_has_none() -> None:
    made = boat_with(
        BOAT, {"hull c_ry": 0.5, "wind c_x": 2.0, "rudder a_h": 1.5, "rudder drift_slope s": 0.7}
    )
    (old,), (new,) = BOAT.thrusters, made.thrusters
    assert made.hull.c_ry == 0.5 * BOAT.hull.c_ry and made.hull.c_rn == BOAT.hull.c_rn
    assert made.wind.c_x == 2.0 * BOAT.wind.c_x
    assert new.rudder.a_h == 1.5 * old.rudder.a_h and new.propeller == old.propeller
    assert new.rudder.drift_slope == pytest.approx(-0.3)
    assert load_boat("esso_osaka") == BOAT


@pytest.mark.parametrize("term", TERMS)
def test_every_term_is_made_of_numbers_of_the_boat_file(term: str) -> None:
    plain = dict.fromkeys(TERMS[term], 1.0)
    assert boat_with(BOAT, plain) == BOAT
    assert not plain or boat_with(BOAT, dict.fromkeys(plain, 1.1)) != BOAT


def test_the_rudders_force_begins_at_the_boat_files_and_ends_at_the_searchs() -> None:
    own, *ends = tried(BOAT)
    assert parameters(with_force(BOAT, *own)) == parameters(BOAT)
    assert ends == [(0.6, -0.3), (0.6, -0.5)]
    changed = parameters(with_force(BOAT, *ends[1]))
    assert changed["rudder_a_h"].item() == 0.6 and changed["rudder_x_h"].item() == -0.5


def test_no_run_is_in_both_halves() -> None:
    random = [blown(f"random_{number}", 1.0, 0.0) for number in range(5)]
    turning = [blown(f"turn_14-{month}-2020_{i}", 1.0, 0.0) for month in ("Oct", "Sep") for i in range(2)]
    first, second = halves(random, turning)
    for kind, whole in ((0, random), (1, turning)):
        assert {run.name for run in (*first[kind], *second[kind])} == {run.name for run in whole}
        assert not {run.name for run in first[kind]} & {run.name for run in second[kind]}


def test_an_interval_across_south_holds_the_anemometer() -> None:
    assert held(wind(2.0, math.pi - 0.05), [blown("a", 2.1, -math.pi + 0.05)]) == [True, True]
    assert held(wind(2.0, 0.0), [blown("a", 2.3, 0.3)]) == [False, False]


def test_each_runs_own_wind_is_compared_with_that_run() -> None:
    groups = {"a": wind(1.0, 0.0), "b": wind(3.0, 1.0)}
    cause = Cause(effect="wind", parameters=wind(2.0, 0.5), scope="run", groups=groups)
    assert winds_held(cause, [blown("a", 1.0, 0.0), blown("b", 3.0, 2.0)]) == [True, True, True, False]
