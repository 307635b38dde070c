"""Righting levers of a hull that heels at constant displacement (thesis 4.5, table 4.10)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid
from scipy.optimize import brentq

from swamp_rl.design.hull_lines import Condition, HullDesign, along, half_breadth
from swamp_rl.design.hydrostatics import Hydrostatics, draught_of, hydrostatics
from swamp_rl.errors import UserError

Array = NDArray[np.float64]
DEGREE = math.pi / 180.0
STRIPS = 200  # of the depth
SLIVER = 1e-9  # m: least breadth of the water's edge across a strip
ANGLES: Array = np.linspace(0.0, 60.0, 61) * DEGREE  # of heel
CRITERIA = {  # table 4.10: least value of each
    "metacentric_height": 0.015,  # m
    "greatest_lever": 0.2,  # m
    "angle_of_greatest": 10.0 * DEGREE,  # rad
    "area_0_30": 0.055,  # m rad
    "area_30_40": 0.03,  # m rad
    "area_0_40": 0.09,  # m rad
}


@dataclass(frozen=True)
class Stability:
    """Of a loading condition, SI units: the upright hydrostatics, GM_T and GM_L, and GZ over the heel.

    centre_of_gravity: VCG; heel [rad], lever GZ and cross KN = GZ + VCG sin φ [m]: vectors of equal length.
    """

    name: str
    centre_of_gravity: float
    upright: Hydrostatics
    heel: Array
    lever: Array
    cross: Array

    @property
    def metacentric_height(self) -> float:
        """GM_T = KM_T − VCG [m]."""
        return self.upright.metacentre_transverse - self.centre_of_gravity

    @property
    def longitudinal_metacentric_height(self) -> float:
        """GM_L = KM_L − VCG [m]."""
        return self.upright.metacentre_longitudinal - self.centre_of_gravity

    @property
    def greatest_lever(self) -> float:
        """The greatest GZ [m]."""
        return float(self.lever.max())

    @property
    def angle_of_greatest(self) -> float:
        """The heel [rad] of the greatest GZ."""
        return float(self.heel[self.lever.argmax()])

    def area(self, low: float, high: float) -> float:
        """∫ GZ dφ [m rad] between two angles [rad] of heel."""
        inside = (self.heel >= low - 1e-9) & (self.heel <= high + 1e-9)
        return float(trapezoid(self.lever[inside], self.heel[inside]))

    @property
    def figures(self) -> dict[str, float]:
        """What the criteria of table 4.10 are about."""
        thirty, forty = 30.0 * DEGREE, 40.0 * DEGREE
        return {
            "metacentric_height": self.metacentric_height,
            "greatest_lever": self.greatest_lever,
            "angle_of_greatest": self.angle_of_greatest,
            "area_0_30": self.area(0.0, thirty),
            "area_30_40": self.area(thirty, forty),
            "area_0_40": self.area(0.0, forty),
        }


def stability(hull: HullDesign, condition: Condition, heel: Array = ANGLES) -> Stability:
    """Stability of a loading condition; UserError where it does not float."""
    draught = condition.draught
    if draught is None:
        assert condition.mass is not None  # the schema has seen to it
        draught = draught_of(hull, condition.mass)
    if draught >= hull.depth:
        raise UserError(f"{hull.name}: {condition.name}: no freeboard above a draught of {draught:g} m")
    upright = hydrostatics(hull, draught)
    cross = np.array([cross_lever(hull, upright.volume, float(angle)) for angle in heel])
    gravity = condition.centre_of_gravity
    return Stability(condition.name, gravity, upright, heel, cross - gravity * np.sin(heel), cross)


def cross_lever(hull: HullDesign, volume: float, heel: float) -> float:
    """KN [m]: horizontal distance of the centre of buoyancy from the keel line at a heel [rad] ≥ 0.

    A point y to starboard and h above the bottom lies y cos φ + h sin φ to starboard, h cos φ − y sin φ up.
    Of each strip between two heights that part is immersed whose upward place is below the water; the water
    stands where the immersed volume [m³] is the given one. The hull is alike fore and aft: it does not trim.
    """
    if heel == 0.0:
        return 0.0
    sine, cosine = math.sin(heel), math.cos(heel)
    x, step = along(hull), hull.depth / STRIPS
    h = np.linspace(0.5 * step, hull.depth - 0.5 * step, STRIPS)
    half = half_breadth(hull, x.at[:, None], h)
    weight = x.weight[:, None] * step

    def immersed(water: float) -> tuple[float, float]:
        """Volume and its moment about the keel line with the water at that height."""
        below = ((h - 0.5 * step) * cosine - water) / sine
        above = below + max(step * cosine / sine, SLIVER)
        total = moment = 0.0
        for centre in hull.centre_planes:
            low, high = centre - half, centre + half
            edge, squared = _means_of_clipped(below, above, low, high)
            wide = high - edge
            total += float((weight * wide).sum())
            moment += float((weight * (0.5 * (high**2 - squared) * cosine + h * wide * sine)).sum())
        return total, moment

    reach = hull.overall_breadth + hull.depth
    if immersed(reach)[0] <= volume:
        raise UserError(f"{hull.name}: no solution: the deck is too low to heel; load less or raise depth")
    water = brentq(lambda at: immersed(at)[0] - volume, -reach, reach, xtol=1e-9)
    total, moment = immersed(water)
    return moment / total


def _means_of_clipped(below: Array, above: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Means of e and of e², e running evenly from `below` to `above`, cut at `low` and `high`.

    The strip's sides are taken as vertical; without the means small heels would fall between the strips.
    """

    def integrals(edge: Array) -> tuple[Array, Array]:
        cut, under, over = np.clip(edge, low, high), np.minimum(edge - low, 0.0), np.maximum(edge - high, 0.0)
        square = cut * cut  # cut**3 would take ten times as long
        return (
            square / 2.0 + low * under + high * over,
            square * cut / 3.0 + low**2 * under + high**2 * over,
        )

    (first, second), (begun, begun_squared) = integrals(above), integrals(below)
    return (first - begun) / (above - below), (second - begun_squared) / (above - below)
