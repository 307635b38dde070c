"""Resistance from the towing tank (thesis Table 4.7), deep and shallow."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.physics.compile import by_field, compiled

# Columns of one row of a tank table: knot speed [m/s], cubic coefficients (highest power first), depth h/T.
SPEED, CUBIC, QUADRATIC, LINEAR, CONSTANT, DEPTH = range(6)


def tank_table(
    curves: list[tuple[float, NDArray[np.float64], NDArray[np.float64]]],
) -> NDArray[np.float64]:
    """Turn towing-tank curves into the array that the compiled functions read.

    curves: (h/T, speeds [m/s], resistances [N]) with h/T increasing. Returns shape (depths, knots, 6): a
    monotone cubic (PCHIP) of R/U^2 in U for each depth, constant outside the tested speeds.
    """
    from scipy.interpolate import PchipInterpolator  # half a second that only a first boat should pay

    knots = max(len(speeds) for _, speeds, _ in curves)
    table = np.zeros((len(curves), knots, 6))
    table[:, :, SPEED] = np.inf
    for row, (depth, speeds, resistances) in zip(table, curves, strict=True):
        factors = resistances / speeds**2
        last = len(speeds) - 1
        row[: last + 1, SPEED] = speeds
        row[:last, CUBIC : CONSTANT + 1] = PchipInterpolator(speeds, factors).c.T
        row[last, CONSTANT] = factors[last]
        row[:, DEPTH] = depth
    return table


@compiled
def factor_at_depth(speed: float, tank: Any, depth: int) -> float:
    """R/U^2 [N s^2/m^2] at one tested depth, a row of the tank table."""
    if speed <= tank[depth, 0, SPEED]:
        return tank[depth, 0, CONSTANT]
    j = 0
    while j + 1 < tank.shape[1] and speed >= tank[depth, j + 1, SPEED]:
        j += 1
    x = speed - tank[depth, j, SPEED]
    cubic, quadratic = tank[depth, j, CUBIC], tank[depth, j, QUADRATIC]
    return ((cubic * x + quadratic) * x + tank[depth, j, LINEAR]) * x + tank[depth, j, CONSTANT]


@compiled
def resistance_factor(speed: float, depth_over_draught: float, tank: Any) -> float:
    """R/U^2 [N s^2/m^2] at any depth: linear in T/h between the tested depths, deep beyond the deepest.

    Shallower than the shallowest test is refused before a simulation starts, never extrapolated here.
    """
    deepest = tank.shape[0] - 1
    if depth_over_draught >= tank[deepest, 0, DEPTH]:
        return factor_at_depth(speed, tank, deepest)
    i = 0
    while i + 2 <= deepest and depth_over_draught >= tank[i + 1, 0, DEPTH]:
        i += 1
    shallow, deep = tank[i, 0, DEPTH], tank[i + 1, 0, DEPTH]
    weight = (1.0 / depth_over_draught - 1.0 / deep) / (1.0 / shallow - 1.0 / deep)
    return weight * factor_at_depth(speed, tank, i) + (1.0 - weight) * factor_at_depth(speed, tank, i + 1)


@compiled
def resistance_scale(p: Any) -> float:
    """Scale from the tank to the boat: density ratio, load to the 2/3 (figure 4.29), its own departure."""
    load = p.mass / p.reference_mass
    return p.resistance_scale * p.water_density / p.reference_density * math.exp(math.log(load) * (2.0 / 3.0))


@compiled
def resistance_of_tank(u: float, v: float, p: Any, tank: Any, scale: float) -> float:
    """Surge force [N] of the resistance, -k(U) u U; the double-ended hull resists astern as ahead."""
    speed = math.sqrt(u * u + v * v)
    return -scale * resistance_factor(speed, p.depth_over_draught, tank) * u * speed


@compiled
def resistance_by_drift(u: float, v: float, p: Any, tank: Any, scale: float) -> float:
    """Surge force [N] by published coefficients, ½ρLd X'_0 u U (Yoshimura 2009).

    X'_0 is linear in the drift angle, from ahead to astern.
    """
    speed = math.sqrt(u * u + v * v)
    drift = abs(math.atan2(v, u)) / math.pi
    x_0 = p.x_0_ahead + (p.x_0_astern - p.x_0_ahead) * drift
    return scale * 0.5 * p.water_density * p.length * p.draught * x_0 * u * speed


surge_resistance = by_field("x_0_ahead", resistance_by_drift, resistance_of_tank)
