"""Hydrostatics of an upright hull over its draught, and its draught over the load."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from swamp_rl.design.hull_lines import HullDesign, along, section, upward, waterline
from swamp_rl.errors import UserError

LEAST_DRAUGHT = 1e-4  # m, below which no draught is looked for


@dataclass(frozen=True)
class Hydrostatics:
    """Of the whole vessel at a draught [m], SI units; heights count from the bottom.

    volume, mass: displaced; wetted_area: with the bottom; block_coefficient and slenderness: of a demihull,
    C_B = ∇/(L B T) with B the greatest, L/∇^⅓; buoyancy_height KB; KM_T, KM_L: of the metacentres; load:
    mass that lowers the vessel by a metre, ρ A_WP [kg/m]; waterplane_area A_WP.
    """

    draught: float
    volume: float
    mass: float
    waterplane_area: float
    wetted_area: float
    block_coefficient: float
    slenderness: float
    buoyancy_height: float
    metacentre_transverse: float
    metacentre_longitudinal: float
    load: float


def hydrostatics(hull: HullDesign, draught: float) -> Hydrostatics:
    """Hydrostatics at a draught [m]; UserError where the deck would be under water.

    KM = KB + I/∇; of two demihulls I_T = Σ (I + A S²/4). Integrals by Gauss-Legendre quadrature; but for the
    wetted area all are of polynomials, and so exact.
    """
    if not 0.0 < draught <= hull.depth:
        raise UserError(
            f"{hull.name}: a draught of {draught:g} m is not above 0 and at most depth {hull.depth:g} m"
        )
    x, h, count = along(hull), upward(hull, draught), hull.demihulls
    f, g = waterline(hull, x.at), section(hull, h.at)
    wide = hull.breadth * float(section(hull, draught))  # of the waterplane at midship
    volume = hull.breadth * float(x.weight @ f) * float(h.weight @ g)
    height = float(h.weight @ (g * h.at)) / float(h.weight @ g)
    plane = wide * float(x.weight @ f)
    transverse = wide**3 / 12.0 * float(x.weight @ f**3) + plane * (0.5 * hull.spacing) ** 2
    longitudinal = wide * float(x.weight @ (f * x.at**2))
    return Hydrostatics(
        draught=draught,
        volume=count * volume,
        mass=count * volume * hull.water_density,
        waterplane_area=count * plane,
        wetted_area=count * _wetted(hull, draught),
        block_coefficient=volume / (hull.length * hull.breadth * draught),
        slenderness=hull.length / volume ** (1.0 / 3.0),
        buoyancy_height=height,
        metacentre_transverse=height + transverse / volume,
        metacentre_longitudinal=height + longitudinal / volume,
        load=count * plane * hull.water_density,
    )


def _wetted(hull: HullDesign, draught: float) -> float:
    """Of one demihull [m²]: both sides, ∬ √(1 + y_x² + y_h²) dx dh each, and the flat bottom."""
    x, h = along(hull), upward(hull, draught)
    f, g = waterline(hull, x.at)[:, None], section(hull, h.at)
    beyond = np.maximum(np.abs(x.at) - hull.middle_half_length, 0.0)[:, None]
    below = np.maximum(hull.freeboard_line - h.at, 0.0)
    along_x = hull.breadth * beyond / hull.end_length**2 * g
    along_h = hull.breadth * f * below / hull.wigley_draught**2
    sides = 2.0 * float(x.weight @ np.sqrt(1.0 + along_x**2 + along_h**2) @ h.weight)
    return sides + hull.breadth * float(section(hull, 0.0)) * float(x.weight @ waterline(hull, x.at))


def draught_of(hull: HullDesign, mass: float) -> float:
    """The draught [m] at which a mass [kg] floats upright; UserError where it would sink."""
    most = hydrostatics(hull, hull.depth).mass
    least = hydrostatics(hull, LEAST_DRAUGHT).mass
    if not least <= mass < most:
        raise UserError(
            f"{hull.name}: no solution: {mass:g} kg do not float between {least:.2g} and {most:.4g} kg"
        )
    return float(brentq(lambda at: hydrostatics(hull, at).mass - mass, LEAST_DRAUGHT, hull.depth, xtol=1e-9))
