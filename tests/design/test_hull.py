"""Lines, hydrostatics and stability: the thesis's numbers, and closed forms of boxes."""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swamp_rl.design.hull_lines import Condition, HullDesign, half_breadth, load_hull
from swamp_rl.design.hydrostatics import draught_of, hydrostatics
from swamp_rl.design.stability import Stability, cross_lever, stability
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, write_yaml

HULL = load_hull("swamp_hull")
FULL, LIGHT = range(2)  # of its conditions


@cache
def loaded(condition: int) -> Stability:
    """The stability of the thesis's hull."""
    return stability(HULL, HULL.conditions[condition])


def changed(**keys: Any) -> HullDesign:
    return HULL.model_copy(update=keys)


def box(demihulls: int = 1, spacing: float = 0.0, **keys: Any) -> HullDesign:
    """A box 2 m long, 0.4 m wide and 0.5 m high: hardly any ends, and sides as good as vertical."""
    shape = {"middle_half_length": 1.0, "end_length": 1e-9, "breadth": 0.4, "wigley_draught": 1e6}
    rest = {"cut": 1e6 - 0.1, "depth": 0.5, "demihulls": demihulls, "spacing": spacing}
    return changed(**(shape | rest | {"water_density": 1000.0} | keys))


def test_the_lines_are_those_of_the_thesis() -> None:
    # (4.6) at x = -0.435, z = 0.075: (B/2) (1 - (0.075/0.22)^2) (1 - (0.185/0.37)^2)
    printed = 0.12 * (1.0 - (0.075 / 0.22) ** 2) * (1.0 - 0.5**2)
    assert half_breadth(HULL, -0.435, 0.075) == pytest.approx(printed)
    assert half_breadth(HULL, 0.435, 0.075) == pytest.approx(printed)  # (4.2) would give 0.039
    assert half_breadth(HULL, 0.2, 0.3) == pytest.approx(0.12)
    assert half_breadth(HULL, [-0.62, 0.62, 0.7], 0.1) == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("printed", "ours"),
    [
        (58.0, lambda: loaded(FULL).upright.mass),
        (0.67, lambda: loaded(FULL).upright.block_coefficient),
        (4.06, lambda: loaded(FULL).upright.slenderness),
        (0.99, lambda: loaded(FULL).upright.wetted_area),
        (0.89, lambda: hydrostatics(HULL, 0.115).wetted_area),
        (0.84, lambda: loaded(FULL).upright.metacentre_longitudinal),
        (0.58, lambda: loaded(FULL).longitudinal_metacentric_height),
        (0.94, lambda: loaded(LIGHT).longitudinal_metacentric_height),
        (0.34, lambda: loaded(FULL).greatest_lever),
        (0.35, lambda: loaded(LIGHT).greatest_lever),
        (0.10, lambda: draught_of(HULL, 38.0)),
        (0.22, lambda: draught_of(HULL, 98.0)),
    ],
)
def test_printed_numbers_are_met_within_3_percent(printed: float, ours: Callable[[], float]) -> None:
    assert ours() == pytest.approx(printed, rel=0.03)


def test_the_transverse_metacentre_is_met_at_the_breadth_of_the_tables_caption() -> None:
    wide = changed(spacing=1.10 - 0.24)
    for printed, one in ((1.66, loaded(FULL)), (2.47, loaded(LIGHT))):
        assert hydrostatics(wide, one.upright.draught).metacentre_transverse == pytest.approx(
            printed, rel=0.03
        )


def test_a_box_has_the_hydrostatics_of_a_box() -> None:
    found = hydrostatics(box(), 0.2)
    assert found.volume == pytest.approx(2.0 * 0.4 * 0.2)
    assert found.mass == pytest.approx(160.0)
    assert found.buoyancy_height == pytest.approx(0.1)
    assert found.block_coefficient == pytest.approx(1.0)
    assert found.metacentre_transverse == pytest.approx(0.1 + 0.4**2 / (12.0 * 0.2))
    assert found.metacentre_longitudinal == pytest.approx(0.1 + 2.0**2 / (12.0 * 0.2))
    # Ends of no length have walls of breadth times draught.
    assert found.wetted_area == pytest.approx(2.0 * 0.4 + 2.0 * 2.0 * 0.2 + 2.0 * 0.4 * 0.2)
    assert draught_of(box(), 160.0) == pytest.approx(0.2)


def test_two_boxes_have_the_inertia_of_their_distance() -> None:
    found = hydrostatics(box(2, 1.0), 0.2)
    assert found.mass == pytest.approx(320.0)
    assert found.metacentre_transverse == pytest.approx(0.1 + (0.4**2 / 12.0 + 0.5**2) / 0.2)


def test_a_wall_sided_box_heels_by_the_closed_form() -> None:
    # GZ = sin φ (GM + BM tan² φ / 2) until the bilge leaves the water or the deck enters it
    hull, gravity = box(), 0.15
    bm = 0.4**2 / (12.0 * 0.2)
    for degrees in (2.0, 10.0, 25.0, 40.0):
        angle = math.radians(degrees)
        gm = 0.1 + bm - gravity
        walled = math.sin(angle) * (gm + 0.5 * bm * math.tan(angle) ** 2)
        lever = cross_lever(hull, 0.16, angle) - gravity * math.sin(angle)
        assert lever == pytest.approx(walled, abs=2e-4)


def test_the_righting_lever_begins_with_the_metacentric_height() -> None:
    heel = np.array([0.0, 1e-3])
    for condition in HULL.conditions:
        one = stability(HULL, condition, heel)
        assert one.lever[0] == 0.0
        assert one.lever[1] / 1e-3 == pytest.approx(one.metacentric_height, rel=2e-3)


def test_a_box_on_its_side_floats_as_the_turned_box() -> None:
    # Half of it is under water at 90 degrees, so that the buoyancy is at half the height, whatever the load.
    assert cross_lever(box(), 0.2, math.pi / 2.0) == pytest.approx(0.25, abs=1e-3)


def test_the_areas_under_the_levers_add_up() -> None:
    figures = loaded(FULL).figures
    assert figures["area_0_40"] == pytest.approx(figures["area_0_30"] + figures["area_30_40"])


@settings(max_examples=25)
@given(mass=st.floats(1.0, 180.0))
def test_the_draught_of_a_load_displaces_it(mass: float) -> None:
    assert hydrostatics(HULL, draught_of(HULL, mass)).mass == pytest.approx(mass, rel=1e-6)


def test_the_load_of_a_metre_is_the_slope_of_the_mass() -> None:
    at, step = 0.12, 1e-5
    rise = hydrostatics(HULL, at + step).mass - hydrostatics(HULL, at - step).mass
    assert hydrostatics(HULL, at).load == pytest.approx(rise / (2.0 * step), rel=1e-6)


def test_a_scaled_hull_has_scaled_hydrostatics() -> None:
    lengths = ("middle_half_length", "end_length", "breadth", "wigley_draught", "cut", "depth", "spacing")
    big = changed(**{key: 3.0 * getattr(HULL, key) for key in lengths})
    one, other = loaded(FULL).upright, hydrostatics(big, 3.0 * 0.14)
    assert other.mass == pytest.approx(27.0 * one.mass)
    assert other.wetted_area == pytest.approx(9.0 * one.wetted_area)
    assert other.metacentre_transverse == pytest.approx(3.0 * one.metacentre_transverse)
    assert other.slenderness == pytest.approx(one.slenderness)


@pytest.mark.parametrize("mass", [500.0, 1e-9])
def test_what_does_not_float_is_refused(mass: float) -> None:
    with pytest.raises(UserError, match="no solution"):
        draught_of(HULL, mass)


@pytest.mark.parametrize(
    ("draught", "message"), [(0.5, "no freeboard above a draught of 0.5 m"), (0.4, "no freeboard above")]
)
def test_a_drowned_deck_is_refused(draught: float, message: str) -> None:
    condition = Condition(name="drowned", draught=draught, centre_of_gravity=0.2)
    with pytest.raises(UserError, match=message):
        stability(HULL, condition, np.array([0.0, 0.1]))


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"cut": 0.3}, "cut must be below wigley_draught"),
        ({"depth": 0.1}, "depth must be at least"),
        ({"spacing": 0.1}, "spacing must be at least breadth"),
        ({"demihulls": 1}, "spacing must be 0 for one hull"),
        ({"beam": 0.2}, "beam: unknown key"),
        ({"conditions": []}, "conditions: is empty"),
        ({"conditions": [{"name": "a", "centre_of_gravity": 0.2}]}, "give either draught or mass"),
        ({"breadth": float("nan")}, "breadth: .*finite"),
    ],
)
def test_a_faulty_file_is_refused_by_key(keys: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "hull.yaml"
    write_yaml(path, read_yaml(find_config("designs", "swamp_hull")) | keys)
    with pytest.raises(UserError, match=message) as refused:
        load_hull(path)
    assert "\n" not in str(refused.value)
