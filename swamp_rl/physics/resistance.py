"""Resistance from the towing tank (thesis Table 4.7), deep and shallow."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.physics.compile import by_field, compiled

# Rows of a tank table at one depth: knot speeds [m/s], cubic coefficients (highest power first), depth h/T.
SPEED, CUBIC, QUADRATIC, LINEAR, CONSTANT, DEPTH = range(6)

Tow = tuple[float, float, int, float]


def tank_table(
    curves: list[tuple[float, NDArray[np.float64], NDArray[np.float64]]],
) -> NDArray[np.float64]:
    """Turn towing-tank curves into the array that the compiled functions read.

    curves: (h/T, speeds [m/s], resistances [N]) with h/T increasing. Returns shape (depths, 6, knots): a
    monotone cubic (PCHIP) of R/U^2 in U for each depth, constant outside the tested speeds. All depths have
    the knots of all, so that a speed falls into the same piece of each curve.
    """
    from scipy.interpolate import PchipInterpolator  # half a second that only a first boat should pay

    knots = np.unique(np.concatenate([speeds for _, speeds, _ in curves]))
    table = np.zeros((len(curves), 6, len(knots)))
    table[:, SPEED] = knots
    for rows, (depth, speeds, resistances) in zip(table, curves, strict=True):
        curve = PchipInterpolator(speeds, resistances / speeds**2)
        tested = (knots >= speeds[0]) & (knots < speeds[-1])
        for row, order in ((CUBIC, 3), (QUADRATIC, 2), (LINEAR, 1)):
            rows[row, tested] = curve(knots[tested], order) / math.factorial(order)
        rows[CONSTANT] = curve(np.clip(knots, speeds[0], speeds[-1]))
        rows[DEPTH] = depth
    return table


@compiled
def piece_of(speed: float, tank: Any) -> tuple[int, float]:
    """Which piece of the curves a speed [m/s] falls into, and how far [m/s] from the piece's knot."""
    piece, left = 0, tank.shape[2]
    while left > 1:  # bisection without a branch, which would be mispredicted too often
        half = left // 2
        piece += half * (speed >= tank[0, SPEED, piece + half])
        left -= half
    return piece, max(speed - tank[0, SPEED, piece], 0.0)


@compiled
def factor_at_depth(piece: int, x: float, tank: Any, depth: int) -> float:
    """R/U^2 [N s^2/m^2] at one tested depth, counted from the shallowest; piece, x: of the speed."""
    cubic, quadratic = tank[depth, CUBIC, piece], tank[depth, QUADRATIC, piece]
    return ((cubic * x + quadratic) * x + tank[depth, LINEAR, piece]) * x + tank[depth, CONSTANT, piece]


@compiled
def depth_place(depth_over_draught: float, tank: Any) -> tuple[int, float]:
    """The next shallower tested depth and its weight w [1], the next deeper one having the rest.

    w is linear in T/h between the tested depths, deep beyond the deepest. Shallower than the shallowest test
    is refused before a simulation starts, never extrapolated here.
    """
    deepest = tank.shape[0] - 1
    if depth_over_draught >= tank[deepest, DEPTH, 0]:
        return deepest, 1.0
    i = 0
    while i + 2 <= deepest and depth_over_draught >= tank[i + 1, DEPTH, 0]:
        i += 1
    shallow, deep = tank[i, DEPTH, 0], tank[i + 1, DEPTH, 0]
    return i, (1.0 / depth_over_draught - 1.0 / deep) / (1.0 / shallow - 1.0 / deep)


@compiled
def resistance_scale(p: Any) -> float:
    """Scale from the tank to the boat: density ratio, load to the 2/3 (figure 4.29), its own departure."""
    load = p.mass / p.reference_mass
    return p.resistance_scale * p.water_density / p.reference_density * np.cbrt(load * load)


@compiled
def towing(p: Any, tank: Any) -> Tow:
    """What a boat takes from the tank at its load and depth: `resistance_scale` ahead and astern, then
    `depth_place`.
    """
    depth, weight = depth_place(p.depth_over_draught, tank)
    scale = resistance_scale(p)
    return scale, scale * p.astern_drag, depth, weight


@compiled
def resistance_of_tank(u: float, v: float, p: Any, tank: Any, tow: Tow) -> float:
    """Surge force [N] of the resistance, -k(U) u U; astern, where u < 0, `astern_drag` times that.

    Between tested depths 1/k is interpolated: 1/k = w/k_shallow + (1 − w)/k_deep. Left out and interpolated
    from the others, the towed depths h/T = 2, 2.5 and 4 come back within 10, 9 and 9 % (rms), against 28, 10
    and 12 % where k is interpolated and 16, 8 and 10 % where log k is. tow: `towing(p, tank)`.
    """
    ahead, astern, depth, weight = tow
    scale = astern if u < 0.0 else ahead
    speed = math.sqrt(u * u + v * v)
    piece, x = piece_of(speed, tank)
    shallow = factor_at_depth(piece, x, tank, depth)
    deep = factor_at_depth(piece, x, tank, min(depth + 1, tank.shape[0] - 1))
    # Without a branch for deep water: that would cost four times what it spares.
    return -scale * shallow * deep / (weight * deep + (1.0 - weight) * shallow) * u * speed


@compiled
def resistance_by_drift(u: float, v: float, p: Any, tank: Any, tow: Tow) -> float:
    """Surge force [N] by published coefficients, ½ρLd X'_0 u U (Yoshimura 2009).

    X'_0 is linear in the drift angle, from ahead to astern; there `astern_drag` comes on top of it.
    """
    speed = math.sqrt(u * u + v * v)
    drift = abs(math.atan2(v, u)) / math.pi
    x_0 = p.x_0_ahead + (p.x_0_astern - p.x_0_ahead) * drift
    scale = tow[1] if u < 0.0 else tow[0]
    return scale * 0.5 * p.water_density * p.length * p.draught * x_0 * u * speed


surge_resistance = by_field("x_0_ahead", resistance_by_drift, resistance_of_tank)
