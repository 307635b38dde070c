"""The hull of the thesis's formulas against its particulars, hydrostatics and stability."""

import math
from collections.abc import Callable
from functools import cache

from benchmarks.validation.check import Check, check
from swamp_rl.design.hull_lines import HullDesign, load_hull
from swamp_rl.design.hydrostatics import draught_of, hydrostatics
from swamp_rl.design.stability import Stability, stability

SHARE = 0.03
HALF_UNIT = 0.005  # m or m rad, of the two decimals of table 4.10
HALF_STEP = 2.5  # deg, of the 5 degrees that its angles of greatest GZ are multiples of
FULL_MASS, LIGHT_MASS, PAYLOAD = 58.0, 38.0, 60.0  # kg: tables 4.5 and 4.8; 4.2.1


def greatest(one: Stability) -> float:
    """Greatest GZ [m]."""
    return one.greatest_lever


def heel(one: Stability) -> float:
    """Heel [deg] of the greatest GZ."""
    return math.degrees(one.angle_of_greatest)


def area(low: int, high: int) -> Callable[[Stability], float]:
    """Area [m rad] under GZ between two heels [deg]."""
    return lambda one: one.area(math.radians(low), math.radians(high))


FIGURES = (
    ("greatest GZ, m", HALF_UNIT, greatest),
    ("heel of the greatest GZ, deg", HALF_STEP, heel),
    ("area 0 to 30°, m rad", HALF_UNIT, area(0, 30)),
    ("area 30 to 40°, m rad", HALF_UNIT, area(30, 40)),
    ("area 0 to 40°, m rad", HALF_UNIT, area(0, 40)),
)
LEVERS = ((0.34, 15, 0.13, 0.05, 0.18), (0.35, 10, 0.14, 0.04, 0.19))  # table 4.10: full payload, lightweight


@cache
def hull_checks() -> list[Check]:
    """Everything that is printed of it."""
    hull = load_hull("swamp_hull")
    full, light = (stability(hull, condition) for condition in hull.conditions)
    return particulars(hull, full) + loads(hull) + metacentres(hull, full, light) + levers(hull)


def particulars(hull: HullDesign, full: Stability) -> list[Check]:
    """Of a demihull and of both at the design draught."""
    up = full.upright
    wet = hydrostatics(hull, 0.115).wetted_area
    found = [
        check("mass at 140 mm, kg", "tables 4.5, 4.7", FULL_MASS, up.mass, SHARE),
        check("mass of a demihull, kg", "table 4.8", 28.5, 0.5 * up.mass, SHARE),
        check("length 2 (a + l), m", "4.3.4", 1.24, hull.length, SHARE),
        check("greatest draught T_prog − Cut_prog, m", "4.3.4", 0.15, hull.wigley_draught - hull.cut, SHARE),
        check("block coefficient C_B", "4.3.4", 0.67, up.block_coefficient, SHARE),
        check("slenderness L/∇^⅓", "tables 4.6, 4.8", 4.06, up.slenderness, SHARE),
        check("L/B", "tables 4.6, 4.8", 5.167, hull.length / hull.breadth, SHARE),
        check("B/T", "tables 4.6, 4.8", 1.714, hull.breadth / up.draught, SHARE),
        check("wetted area at 140 mm, m²", "table 4.5", 0.99, up.wetted_area, SHARE),
        check("wetted area of a demihull, m²", "table 4.8", 0.5, 0.5 * up.wetted_area, SHARE),
        check("wetted area at 115 mm, m²", "table 4.5", 0.89, wet, SHARE),
    ]
    for breadth, printed in ((0.82, 0.46), (1.10, 0.68), (1.25, 0.80)):
        ratio = (breadth - hull.breadth) / hull.length
        found.append(check(f"S/L at a breadth of {breadth:.2f} m", "table 4.5", printed, ratio, SHARE))
    return found


def loads(hull: HullDesign) -> list[Check]:
    """Draughts and volumes of loads."""
    volumes = {draught: hydrostatics(hull, draught).volume for draught in (0.14, 0.115)}
    at_115 = hull.water_density * volumes[0.115]
    floats = f"48 kg float at {1e3 * draught_of(hull, 48.0):.0f} mm."
    return [
        check("draught at 38 kg, m", "4.2.1", 0.10, draught_of(hull, LIGHT_MASS), SHARE),
        check(
            "draught with 60 kg of payload, m", "4.2.1", 0.22, draught_of(hull, LIGHT_MASS + PAYLOAD), SHARE
        ),
        check("draught at 60 kg, m", "table 4.1", 0.15, draught_of(hull, 60.0), SHARE),
        check(
            "mass at 115 mm, kg",
            "table 4.5",
            48,
            at_115,
            SHARE,
            reason=f"the lines that 4.3.4 prints displace {at_115:.1f} kg at 115 mm; {floats}",
            contradicted=True,
        ),
        *(
            check(
                f"displaced volume at {1e3 * draught:.0f} mm, m³",
                "table 4.5",
                printed,
                volumes[draught],
                SHARE,
                reason=f"{mass} kg, printed for this draught, are {mass / 1e3:g} m³ of water; the table's "
                "volumes are ten times too large.",
                contradicted=True,
            )
            for draught, printed, mass in ((0.14, 0.58, 58), (0.115, 0.48, 48))
        ),
    ]


def widened(hull: HullDesign) -> HullDesign:
    """The hull at the breadth of table 4.10's caption."""
    return hull.model_copy(update={"spacing": 1.10 - hull.breadth})


def metacentres(hull: HullDesign, full: Stability, light: Stability) -> list[Check]:
    """Table 4.10's upper half: KM_T at the spacing of table 4.1, and at that of the table's own caption."""
    wide = widened(hull)
    where, found = "table 4.10", []
    for name, one, draught, height, gm_l, km_t, gm_t in (
        ("full payload", full, 0.14, 0.08, 0.58, 1.66, 1.40),
        ("lightweight", light, 0.09, 0.05, 0.94, 2.47, 2.19),
    ):
        up = one.upright
        wider = hydrostatics(wide, up.draught).metacentre_transverse
        reason = f"S = 0.80 m is table 4.1's; the caption's breadth of 1.10 m gives KM_T = {wider:.2f} m."
        longitudinal = one.longitudinal_metacentric_height
        found += [
            check(f"{name}: draught, m", where, draught, up.draught, SHARE, HALF_UNIT),
            check(f"{name}: centre of buoyancy Z_b, m", where, height, up.buoyancy_height, SHARE, HALF_UNIT),
            check(f"{name}: GM_L, m", where, gm_l, longitudinal, SHARE, HALF_UNIT),
        ]
        for spacing, value in ((hull.spacing, up.metacentre_transverse), (wide.spacing, wider)):
            height = value - one.centre_of_gravity
            for what, printed, ours in (("KM_T", km_t, value), ("GM_T", gm_t, height)):
                message, reading_of = f"{name}: {what} at S = {spacing:.2f} m, m", f"{what}, {name}"
                found.append(check(message, where, printed, ours, SHARE, HALF_UNIT, reason, reading_of))
    return found


def levers(hull: HullDesign) -> list[Check]:
    """Table 4.10's lower half, at both spacings."""
    where, found = "table 4.10", []
    both = [hull, widened(hull)]
    for condition, printed in zip(hull.conditions, LEVERS, strict=True):
        name = condition.name.replace("_", " ")
        levered = [stability(one, condition) for one in both]
        for (what, width, of), value in zip(FIGURES, printed, strict=True):
            ours = [of(one) for one in levered]
            reason = (
                f"S = {both[0].spacing:.2f} m, printed in table 4.1, gives {ours[0]:.3g}; the caption's "
                f"breadth of 1.10 m, S = {both[1].spacing:.2f} m, gives {ours[1]:.3g}."
            )
            number = f"{name}: {what}"
            for one, figure in zip(both, ours, strict=True):
                message = f"{number}, S = {one.spacing:.2f} m"
                found.append(
                    check(message, where, value, figure, SHARE, width, reason, number, contradicted=True)
                )
    return found
