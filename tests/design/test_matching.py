"""Propellers on a hull: the steady run balances, and the best range is the least energy a metre."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.design.matching import (
    MatchDesign,
    Pitch,
    best_ranges,
    drag_factor,
    drag_of,
    energy_per_metre,
    load_match,
    matched_advance,
    matches,
)
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, write_yaml

KNOT = 1852.0 / 3600.0
DESIGN = load_match("typhoon_match")
ON_A_BOAT = {
    "vehicle": {"boat": "swamp"},
    "water_density": None,
    "design_speed": 1.0,
    "onboard_power": [88.0],
}


def changed(**keys: Any) -> MatchDesign:
    return MatchDesign.model_validate(DESIGN.model_dump() | keys)


def test_advance_coefficients_of_the_typhoon_lie_where_the_independent_program_has_them() -> None:
    assert [match.advance for match in matches(DESIGN)] == pytest.approx([0.59, 0.67, 0.75], abs=0.006)


def test_50_and_200_watts_give_2_6_and_4_1_knots() -> None:
    speeds = [one.speed / KNOT for one in best_ranges(load_match("typhoon_cfd"))]
    assert speeds == pytest.approx([2.6, 4.1], abs=0.05)


def test_table_2_is_right_at_two_metres_a_second() -> None:
    assert drag_factor(0.1278, 0.33, 1025.0) * 2.0**2 == pytest.approx(22.40, rel=0.01)


def test_in_a_steady_run_the_propellers_make_the_drag() -> None:
    drag = drag_of(DESIGN).force(DESIGN.design_speed)
    for match in matches(DESIGN):
        assert DESIGN.propellers.count * match.thrust == pytest.approx(drag)
        assert match.revolutions * match.advance * DESIGN.propellers.diameter == pytest.approx(2.0)


@given(factor=st.floats(1e-3, 1e4), bollard=st.floats(0.01, 2.0), ratio=st.floats(0.2, 3.0))
def test_the_matched_advance_solves_equation_15(factor: float, bollard: float, ratio: float) -> None:
    of = DESIGN.propellers
    found = matched_advance(
        factor, 1000.0, of, Pitch(name="p", pitch_ratio=ratio, bollard_coefficient=bollard)
    )
    thrust = of.hull_efficiency * of.count * bollard * 1000.0 * of.diameter**2
    assert factor * found**2 == pytest.approx(-thrust * (found / (of.null_factor * ratio) - 1.0), rel=1e-6)
    assert 0.0 < found < of.null_factor * ratio


def test_more_drag_lowers_the_advance_and_more_pitch_raises_it() -> None:
    draggy = changed(vehicle={"drag_coefficient": 0.7, "diameter": 0.33})
    for match, slower in zip(matches(DESIGN), matches(draggy), strict=True):
        assert slower.advance < match.advance
    advances = [match.advance for match in matches(DESIGN)]
    assert advances == sorted(advances)


def test_at_best_range_driving_takes_a_third_of_the_power_and_no_other_speed_less() -> None:
    drag = drag_of(DESIGN)
    for one in best_ranges(DESIGN):
        assert one.propulsion_power == pytest.approx(one.total_power / 3.0)
        assert one.range == pytest.approx(DESIGN.energy / one.energy_per_metre)
        for other in (0.98, 1.02):
            assert energy_per_metre(DESIGN, drag, one.onboard_power, other * one.speed) > one.energy_per_metre


def test_a_boats_tank_table_gives_a_best_range_within_what_was_towed() -> None:
    design = changed(**ON_A_BOAT)
    drag = drag_of(design)
    (best,) = best_ranges(design)
    assert drag.low < best.speed < drag.high
    for step in (-0.02, 0.02):
        spent = energy_per_metre(design, drag, best.onboard_power, best.speed + step)
        assert spent > best.energy_per_metre


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (ON_A_BOAT | {"onboard_power": [0.01]}, "lies below the towed"),
        (ON_A_BOAT | {"onboard_power": [1e6]}, "lies above the towed"),
        (ON_A_BOAT | {"design_speed": 3.0}, "not within the towed"),
        (ON_A_BOAT | {"vehicle": {"boat": "esso_osaka"}}, "no table of a towing tank"),
        (ON_A_BOAT | {"vehicle": {"boat": "nowhere"}}, "no boat file named"),
    ],
)
def test_a_match_without_a_solution_is_refused_on_one_line(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message) as refused:
        design = changed(**keys)
        matches(design)
        best_ranges(design)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"vehicle": {"drag_coefficient": 0.3}}, "vehicle: give either boat, or"),
        ({"water_density": None}, "water_density: give it"),
        ({"efficiency": 0.0}, "efficiency: .*greater than 0"),
        ({"onboard_power": []}, "onboard_power: is empty"),
        ({"energie": 1.0}, "energie: unknown key; did you mean 'energy'"),
    ],
)
def test_a_faulty_file_is_refused_by_key(keys: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "match.yaml"
    write_yaml(path, read_yaml(find_config("designs", "typhoon_match")) | keys)
    with pytest.raises(UserError, match=message) as refused:
        load_match(path)
    assert "\n" not in str(refused.value)
