"""The pump-jet's design meets the thesis's table 5.1 and the laws that it is made of."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.design.pump_jet import (
    GRAVITY,
    PumpJetDesign,
    design_pump_jet,
    geometry_of,
    jet_speed,
    load_pump_jet,
    running_at,
)
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, write_yaml

JET = design_pump_jet(load_pump_jet("swamp_pump_jet"))


def changed(**keys: Any) -> PumpJetDesign:
    return PumpJetDesign.model_validate(JET.design.model_dump() | keys)


@pytest.mark.parametrize(
    ("printed", "ours"),
    [
        (1.70, JET.head),
        (47.0, JET.specific_speed),
        (2430.0, JET.us_specific_speed),
        (0.88, JET.speed_constant),
        (0.39, JET.head_coefficient),
        (0.302, JET.capacity_constants[0]),
        (0.122, JET.capacity_constants[1]),
    ],
)
def test_table_5_1_is_met_within_2_5_percent(printed: float, ours: float) -> None:
    assert ours == pytest.approx(printed, rel=0.025)


def test_the_vane_angles_of_table_5_1_are_met_within_0_6_degrees() -> None:
    assert math.degrees(JET.inlet[1].angle) == pytest.approx(39.5, abs=0.6)
    assert math.degrees(JET.outlet[1].angle) == pytest.approx(21.3, abs=0.6)
    assert JET.efficient


def test_the_jets_momentum_is_the_thrust_and_the_power_that_of_the_head() -> None:
    design, water = JET.design, JET.design.water_density
    momentum = water * JET.flow * JET.outlet_speed * math.cos(design.nozzle_angle)
    assert momentum == pytest.approx(design.thrust)
    hydraulic = water * GRAVITY * JET.flow * JET.head
    assert JET.shaft_power == pytest.approx(hydraulic / 0.75 / 0.95)
    assert JET.electric_power == pytest.approx(JET.shaft_power / 0.85)


def test_water_that_comes_in_faster_must_leave_faster() -> None:
    moving = jet_speed(changed(inlet_speed=1.0))
    design = JET.design
    along = design.thrust / math.cos(design.nozzle_angle)
    assert design.water_density * design.nozzle_area * moving * (moving - 1.0) == pytest.approx(along)
    assert moving > JET.outlet_speed


def test_the_triangles_close_and_eulers_equation_gives_the_head() -> None:
    for triangle in (*JET.inlet, *JET.outlet):
        assert triangle.whirl + triangle.relative_whirl == pytest.approx(triangle.blade)
        assert triangle.relative * math.sin(triangle.angle) == pytest.approx(triangle.meridian)
    for inlet, outlet in zip(JET.inlet, JET.outlet, strict=True):
        work = outlet.blade * outlet.whirl - inlet.blade * inlet.whirl
        assert work / GRAVITY == pytest.approx(JET.head)  # a free vortex: the same on each streamline


def test_mean_diameters_halve_the_flow_at_the_outlet() -> None:
    tip, mean, root = JET.geometry.outlet
    assert mean**2 == pytest.approx((tip**2 + root**2) / 2.0)


def test_the_inlets_root_is_that_of_the_print() -> None:
    tip, mean, root = JET.geometry.inlet
    assert root == pytest.approx(math.sqrt(tip**2 - 2.0 * mean**2))


def test_a_slipping_outlet_needs_a_steeper_vane() -> None:
    assert 0.0 < JET.slip < 1.0
    assert JET.vane_angle > JET.outlet[1].angle
    many = design_pump_jet(changed(blades=40))
    assert JET.slip < many.slip < 1.0


def test_throttle_follows_the_affinity_laws() -> None:
    half, full = running_at(JET, 0.5), running_at(JET, 1.0)
    assert (full.thrust, full.electric_power) == (JET.design.thrust, JET.electric_power)
    assert half.flow == pytest.approx(full.flow / 2.0)
    assert half.thrust == pytest.approx(full.thrust / 4.0)
    assert half.shaft_power == pytest.approx(full.shaft_power / 8.0)
    assert running_at(JET, 0.0).thrust == 0.0


@given(scale=st.floats(0.2, 20.0))
def test_a_design_of_another_size_at_the_same_jet_speed_is_alike(scale: float) -> None:
    design = JET.design
    bigger = design_pump_jet(
        changed(
            module_diameter=design.module_diameter * scale,
            nozzle_area=design.nozzle_area * scale**2,
            thrust=design.thrust * scale**2,
            revolutions=design.revolutions / scale,
        )
    )
    assert bigger.head == pytest.approx(JET.head)
    assert bigger.specific_speed == pytest.approx(JET.specific_speed)
    assert bigger.outlet[1].angle == pytest.approx(JET.outlet[1].angle)
    assert bigger.electric_power == pytest.approx(JET.electric_power * scale**2)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"thrust": 60.0}, "no solution: a head of"),
        ({"revolutions": 15.0}, "raise revolutions above"),
        ({"inlet_whirl": 3.0}, "inlet_whirl 3 m/s is not below"),
        ({"inlet_height_ratio": 0.3}, "must descend and be above 0"),
        ({"outlet_tip_ratio": 0.3}, "leaves no root at the outlet"),
        ({"outlet_mean_ratio": 2.0, "outlet_tip_ratio": 2.0}, "narrower than the inlet"),
        ({"blades": 3, "thrust": 14.0}, "add blades"),
    ],
)
def test_a_design_without_a_solution_is_refused_on_one_line(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message) as refused:
        design_pump_jet(changed(**keys))
    assert "\n" not in str(refused.value)


@given(st.dictionaries(st.sampled_from(sorted(PumpJetDesign.model_fields)), st.floats(-1e3, 1e3), max_size=3))
def test_whatever_numbers_a_design_has_it_is_refused_or_has_a_finite_result(keys: dict[str, float]) -> None:
    try:
        jet = design_pump_jet(changed(**keys))
    except (UserError, ValueError):
        return
    assert math.isfinite(jet.electric_power) and jet.electric_power > 0.0
    assert 0.0 < jet.outlet[1].angle < math.pi / 2.0
    assert geometry_of(jet.design).outlet_area > 0.0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            {"thrust": {"value": 12.0, "unit": "kN", "provenance": "measured", "source": "s"}},
            "thrust: .*'kN'",
        ),
        ({"blade": 9}, "blade: unknown key; did you mean 'blades'"),
        ({"thrust": -1.0}, "thrust: .*greater than 0"),
        ({"pump_efficiency": 1.2}, "pump_efficiency: must be at most 1"),
        ({"blades": 9.5}, "blades: .*whole number"),
        ({"design": "hull"}, "design: is 'hull'"),
    ],
)
def test_a_faulty_file_is_refused_by_key(keys: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "jet.yaml"
    write_yaml(path, read_yaml(find_config("designs", "swamp_pump_jet")) | keys)
    with pytest.raises(UserError, match=f"jet.yaml: {message}") as refused:
        load_pump_jet(path)
    assert "\n" not in str(refused.value)
