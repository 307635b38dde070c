"""A designed hull: hydrostatics, draught over load, righting levers, and a boat file with its draught."""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.design import (
    Quantity,
    Table,
    as_json,
    boat_file,
    designed,
    spec,
    write_design,
)
from swamp_rl.experiments.reports.design_hull_figure import draw_hull

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.design.hull_lines import HullDesign, load_hull
from swamp_rl.design.hydrostatics import Hydrostatics, draught_of, hydrostatics
from swamp_rl.design.stability import CRITERIA, Stability, stability

FIGURE = "hull.png"
STEPS = 40  # of the draught and of the load
HYDROSTATICS = {
    "draught": "m",
    "volume": "m3",
    "mass": "kg",
    "waterplane_area": "m2",
    "wetted_area": "m2",
    "block_coefficient": "1",
    "slenderness": "1",
    "buoyancy_height": "m",
    "metacentre_transverse": "m",
    "metacentre_longitudinal": "m",
    "load": "kg/m",
}
LEVERS = {"condition": "", "heel": "rad", "gz": "m", "kn": "m"}
MEANING = {
    "metacentric_height": ("m", "metacentric height GM_T"),
    "greatest_lever": ("m", "greatest GZ"),
    "angle_of_greatest": ("rad", "at a heel of"),
    "area_0_30": ("m rad", "area 0 to 30 deg"),
    "area_30_40": ("m rad", "area 30 to 40 deg"),
    "area_0_40": ("m rad", "area 0 to 40 deg"),
}


def write_hull(out: Path, asked: str, boat: str) -> list[str]:
    """Work out the hull of a file and write it into `out`; lines to print. UserError if it does not float."""
    hull = load_hull(asked)
    conditions = [stability(hull, condition) for condition in hull.conditions]
    over_draught = [
        hydrostatics(hull, float(draught)) for draught in np.linspace(0.0, hull.depth, STEPS + 1)[1:]
    ]
    found = {one.name: quantities(hull, one) for one in conditions}
    content = {
        "design": "hull",
        "asked": spec(hull),
        "length": hull.length,
        "overall_breadth": hull.overall_breadth,
        "conditions": {name: as_json(some) for name, some in found.items()},
        "criteria_met": {one.name: met(one) for one in conditions},
    }
    tables = [
        Table("hydrostatics.csv", HYDROSTATICS, [row_of(one) for one in over_draught]),
        Table("load.csv", {"mass": "kg", "draught": "m"}, draught_over_load(hull)),
        Table("levers.csv", LEVERS, lever_rows(conditions)),
    ]
    changes = floating(hull, conditions[0]) | as_before(load_boat(boat), hull, conditions[0])
    drawn = partial(draw_hull, hull=hull, over_draught=over_draught, conditions=conditions)
    write_design(out, asked, content, tables, (FIGURE, drawn), boat_file(boat, changes))
    lines = []
    for one in conditions:
        lines += [f"{hull.name}, {one.name}", *(f"  {each.line}" for each in found[one.name])]
    return lines


def floating(hull: HullDesign, condition: Stability) -> dict[str, Any]:
    """The keys of a boat file that the hull gives at a condition."""
    source = f"design {hull.name}, {condition.name}"
    upright = condition.upright
    return {
        "length": designed(hull.length, "m", source),
        "breadth": designed(hull.overall_breadth, "m", source),
        "draught": designed(upright.draught, "m", source),
        "mass": designed(upright.mass, "kg", source),
        "water_density": designed(hull.water_density, "kg/m3", source),
        "hull": {"spacing": designed(hull.spacing, "m", source)},
        "loading": loading(hull),
    }


def as_before(boat: Boat, hull: HullDesign, condition: Stability) -> dict[str, Any]:
    """The section `resistance` by which the extended boat keeps its resistance [N]: X'_0 is per ½ρLd, which
    the hull changes. Empty for a towing tank's results.
    """
    if not isinstance(boat.resistance, DriftResistance):
        return {}
    before = boat.water_density * boat.length * boat.draught
    ratio = before / (hull.water_density * hull.length * condition.upright.draught)
    source = f"boat {boat.name}, times {ratio:.4g} for the same resistance by the draught of {hull.name}"
    scaled: dict[str, Any] = {}
    for name in DriftResistance.model_fields:
        sd = boat.provenance[f"resistance.{name}"].sd
        spread = {} if sd is None else {"sd": ratio * float(np.max(sd))}
        scaled[name] = designed(ratio * getattr(boat.resistance, name), "1", source) | spread
    return {"resistance": scaled}


def loading(hull: HullDesign) -> dict[str, Any]:
    """The section `loading` of a boat file."""
    source = f"design {hull.name}, hydrostatics"
    masses, draughts = (list(column) for column in zip(*draught_over_load(hull), strict=True))
    values = {"density": (hull.water_density, "kg/m3"), "mass": (masses, "kg"), "draught": (draughts, "m")}
    return {
        key: {"value": value, "unit": unit, "provenance": "assumed", "source": source}
        for key, (value, unit) in values.items()
    }


def row_of(one: Hydrostatics) -> list[float]:
    """A row of `HYDROSTATICS`."""
    return [getattr(one, name) for name in HYDROSTATICS]


def draught_over_load(hull: HullDesign) -> list[tuple[float, float]]:
    """Mass [kg] and draught [m] from a fortieth of what sinks it to just below that."""
    most = hydrostatics(hull, hull.depth).mass
    loads = [most * step / STEPS for step in range(1, STEPS)]
    return [(mass, draught_of(hull, mass)) for mass in loads]


def lever_rows(conditions: Sequence[Stability]) -> list[tuple[str, float, float, float]]:
    """Rows of `LEVERS`."""
    return [
        (one.name, float(heel), float(lever), float(cross))
        for one in conditions
        for heel, lever, cross in zip(one.heel, one.lever, one.cross, strict=True)
    ]


def met(condition: Stability) -> dict[str, bool]:
    """Whether each criterion of table 4.10 is met."""
    figures = condition.figures
    return {name: figures[name] >= least for name, least in CRITERIA.items()}


def quantities(hull: HullDesign, condition: Stability) -> list[Quantity]:
    """What tables 4.8 and 4.10 list of a loading condition."""
    up, fulfilled = condition.upright, met(condition)
    found = [
        Quantity("draught", up.draught, "m", "draught"),
        Quantity("mass", up.mass, "kg", "mass"),
        Quantity("block_coefficient", up.block_coefficient, "1", "block coefficient of a demihull C_B"),
        Quantity("slenderness", up.slenderness, "1", "slenderness of a demihull L/∇^(1/3)"),
        Quantity("length_over_breadth", hull.length / hull.breadth, "1", "L/B of a demihull"),
        Quantity("breadth_over_draught", hull.breadth / up.draught, "1", "B/T of a demihull"),
        Quantity("wetted_area", up.wetted_area, "m2", "wetted area"),
        Quantity("load", up.load, "kg/m", "load for a metre of draught"),
        Quantity("buoyancy_height", up.buoyancy_height, "m", "centre of buoyancy KB"),
        Quantity("metacentre_transverse", up.metacentre_transverse, "m", "transverse metacentre KM_T"),
        Quantity("metacentre_longitudinal", up.metacentre_longitudinal, "m", "longitudinal metacentre KM_L"),
        Quantity(
            "longitudinal_metacentric_height",
            condition.longitudinal_metacentric_height,
            "m",
            "longitudinal metacentric height GM_L",
        ),
    ]
    for key, value in condition.figures.items():
        unit, meaning = MEANING[key]
        degrees = f"{math.degrees(value):.0f} deg"
        shown = degrees if key == "angle_of_greatest" else f"{value:.4g} {unit}"
        least = math.degrees(CRITERIA[key]) if key == "angle_of_greatest" else CRITERIA[key]
        verdict = f"{'meets' if fulfilled[key] else 'FAILS'} the criterion, at least {least:g}"
        found.append(Quantity(key, value, unit, meaning, f"{shown:<14} {verdict}"))
    return found
