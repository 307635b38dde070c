"""Lines of SWAMP's demihull: a Wigley hull with a parallel middle body and a flat bottom (thesis 4.3.4).

Heights h count from the bottom; the thesis's z counts down from the freeboard line, z = T_prog − Cut − h.
Half breadth y = (B/2) f(x) g(h), with

    f(x) = 1 for |x| ≤ a, else 1 − ((|x| − a)/l)²          (4.1, 4.3, 4.5)
    g(h) = 1 − (z/T_prog)² below the freeboard line, else 1  (4.4, 4.6)

(4.2) prints (1 − z/T_prog)² in place of 1 − (z/T_prog)²; with it C_B is 0.51 and the hull is not symmetric
fore and aft. (4.6)'s form is taken on both sides.
"""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from swamp_rl.boat.part import FILLED, FROM_LIST, NAME, NOT_NEGATIVE, POSITIVE, WATER, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.design.read import read_design

Array = NDArray[np.float64]
ORDER = 12  # of the Gauss-Legendre quadrature on each smooth piece; exact to polynomials of degree 23
NODES = leggauss(ORDER)
MOST_CONDITIONS = 20


class Condition(Part):
    """A loading condition: draught or mass, and height of the centre of gravity above the bottom."""

    name: Annotated[str, NAME]
    "Name in tables and figures."
    draught: Annotated[float | None, POSITIVE, Unit("m")] = None
    "Draught of the hull, or give mass."
    mass: Annotated[float | None, POSITIVE, Unit("kg")] = None
    "Mass of the vessel, or give draught."
    centre_of_gravity: Annotated[float, NOT_NEGATIVE, Unit("m")]
    "VCG: above the bottom."

    @model_validator(mode="after")
    def _has_one_load(self) -> Self:
        if (self.draught is None) == (self.mass is None):
            raise ValueError(f"{self.name}: give either draught or mass")
        return self


class HullDesign(Part):
    """A vessel of equal demihulls by the thesis's formulas, and the conditions that it is loaded to."""

    design: Literal["hull"]
    "Kind of design."
    name: Annotated[str, Field(min_length=1)]
    "Name in tables; the file's by default."
    middle_half_length: Annotated[float, POSITIVE, Unit("m")]
    "a: half the length of the parallel middle body."
    end_length: Annotated[float, POSITIVE, Unit("m")]
    "l: length of each end."
    breadth: Annotated[float, POSITIVE, Unit("m")]
    "B: of a demihull."
    wigley_draught: Annotated[float, POSITIVE, Unit("m")]
    "T_prog: from the freeboard line to the keel of the hull before its bottom is cut off."
    cut: Annotated[float, POSITIVE, Unit("m")]
    "Cut_prog: height of what is cut off."
    depth: Annotated[float, POSITIVE, Unit("m")]
    "Depth from the bottom to the deck."
    demihulls: Annotated[int, Field(ge=1, le=2)]
    "1, or 2 side by side."
    spacing: Annotated[float, NOT_NEGATIVE, Unit("m")]
    "S: between the centre planes of two demihulls; 0 for one."
    water_density: Annotated[float, WATER, Unit("kg/m3")]
    "Density of the water."
    conditions: Annotated[tuple[Condition, ...], FROM_LIST, FILLED, Field(max_length=MOST_CONDITIONS)]
    "The first one is what the boat file is written for."

    @model_validator(mode="after")
    def _can_be_built(self) -> Self:
        if not self.cut < self.wigley_draught:
            raise ValueError("cut must be below wigley_draught, or nothing of the hull is left")
        if self.depth < self.freeboard_line:
            raise ValueError(f"depth must be at least wigley_draught - cut = {self.freeboard_line:g} m")
        if self.demihulls == 2 and self.spacing < self.breadth:
            raise ValueError("spacing must be at least breadth, or the demihulls overlap")
        if self.demihulls == 1 and self.spacing != 0.0:
            raise ValueError("spacing must be 0 for one hull")
        for name in ("depth", "spacing"):
            if getattr(self, name) > self.length:
                raise ValueError(f"{name} must be at most the length, {self.length:g} m")
        names = [condition.name for condition in self.conditions]
        if len(set(names)) < len(names):
            raise ValueError(f"conditions: names must differ, but are {', '.join(names)}")
        return self

    @property
    def length(self) -> float:
        """L = 2 (a + l) [m]."""
        return 2.0 * (self.middle_half_length + self.end_length)

    @property
    def freeboard_line(self) -> float:
        """Height [m] above the bottom from which on the sides are vertical: T_prog − Cut."""
        return self.wigley_draught - self.cut

    @property
    def overall_breadth(self) -> float:
        """Over both demihulls [m]."""
        return self.breadth + self.spacing

    @property
    def centre_planes(self) -> tuple[float, ...]:
        """Of each demihull, starboard of the centre line [m]."""
        half = 0.5 * self.spacing
        return (-half, half) if self.demihulls == 2 else (0.0,)


def load_hull(name_or_path: str | Path) -> HullDesign:
    """The hull design of a file; UserError as in `read_design`."""
    return read_design(name_or_path, "hull", HullDesign)


def waterline(hull: HullDesign, x: ArrayLike) -> Array:
    """f(x) [1] at x [m] forward of midship; 0 beyond the ends."""
    beyond = np.maximum(np.abs(np.asarray(x, float)) - hull.middle_half_length, 0.0)
    return np.maximum(1.0 - (beyond / hull.end_length) ** 2, 0.0)


def section(hull: HullDesign, height: ArrayLike) -> Array:
    """g(h) [1] at a height h [m] above the bottom."""
    below = np.maximum(hull.freeboard_line - np.asarray(height, float), 0.0)
    return 1.0 - (below / hull.wigley_draught) ** 2


def half_breadth(hull: HullDesign, x: ArrayLike, height: ArrayLike) -> Array:
    """y [m] of a demihull at x [m] and a height [m] above the bottom, which must broadcast."""
    return 0.5 * hull.breadth * waterline(hull, x) * section(hull, height)


@dataclass(frozen=True)
class Nodes:
    """Places [m] and weights [m] of a quadrature."""

    at: Array
    weight: Array


def along(hull: HullDesign) -> Nodes:
    """Of the length: the stern, the middle body, the bow."""
    a, end = hull.middle_half_length, 0.5 * hull.length
    return _pieces([-end, -a, a, end])


def upward(hull: HullDesign, draught: float) -> Nodes:
    """Of the immersed height: below and above the freeboard line."""
    line = hull.freeboard_line
    return _pieces([0.0, draught] if draught <= line else [0.0, line, draught])


def _pieces(edges: list[float]) -> Nodes:
    node, weight = NODES
    half = [0.5 * (high - low) for low, high in pairwise(edges)]
    middle = [0.5 * (high + low) for low, high in pairwise(edges)]
    at = [m + h * node for m, h in zip(middle, half, strict=True)]
    return Nodes(np.concatenate(at), np.concatenate([h * weight for h in half]))
