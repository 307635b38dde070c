"""Thrust over revolutions and speed of advance: propellers of three models, and measured tables.

Propellers as Allotta et al. 2018 have them (equations are theirs, corrected as docs/propellers.md says),
without a division by the revolutions.
"""

import math
from typing import Any

from swamp_rl.physics.compile import compiled

SCREW = "screw_model"  # the record's field: which of these models, 0 for a thruster without one
DISC, LINEAR, FOUR_QUADRANT, TABLE = 1.0, 2.0, 3.0, 4.0
TANGENTIAL = 0.7 * math.pi  # of (20): speed at 0.7 of the radius over n d


@compiled
def disc_thrust(n: float, inflow: float, k: int, p: Any) -> float:
    """ρ d⁴ n² K_t(J) [N] of the bladed disc (11), (15), 0 ≤ J ≤ p/d; n ≥ 0.

    With x = Δ_v/d: T = ρ d⁴ π/16 (2 (V/d) x + x²), where (15) times n² gives x.
    """
    pitch = p.screw_pitch[k]
    inverse = (math.pi / pitch) ** 2
    v = min(max(inflow / p.screw_diameter[k], 0.0), n * pitch)
    a, b, c = 1.0 + 0.25 * inverse, v * (2.0 + inverse), v * v * inverse - (math.pi * n) ** 2
    x = (math.sqrt(max(b * b - 4.0 * a * c, 0.0)) - b) / (2.0 * a)
    return p.water_density * p.screw_diameter[k] ** 4 * math.pi / 16.0 * (2.0 * v + x) * x


@compiled
def four_quadrant_thrust(n: float, inflow: float, k: int, p: Any) -> float:
    """ρ π d²/8 (V² + (0.7 π n d)²) C_t*(β) [N] (21), C_t* by its Fourier series (23).

    The thruster's numbers: A_0, B_0, A_1, B_1, ...
    """
    d = p.screw_diameter[k]
    around = TANGENTIAL * n * d
    square = inflow * inflow + around * around
    if square == 0.0:
        return 0.0
    speed = math.sqrt(square)
    cos, sin = around / speed, inflow / speed
    cos_k, sin_k, factor = 1.0, 0.0, 0.0
    for order in range(int(p.screw_orders[k])):
        factor += p.screw_numbers[k, 2 * order] * cos_k + p.screw_numbers[k, 2 * order + 1] * sin_k
        cos_k, sin_k = cos_k * cos - sin_k * sin, sin_k * cos + cos_k * sin
    return p.water_density * math.pi * d * d / 8.0 * square * factor


@compiled
def propeller_thrust(n: float, inflow: float, k: int, p: Any) -> float:
    """Thrust [N] of the propeller of thruster k in open water at n [rps] and V_a [m/s], of either sign.

    Linear: ρ d⁴ K_t(0) |n| (n − V_a/(d J_0)) (19); astern the disc is its own mirror image.
    """
    if p.screw_model[k] == FOUR_QUADRANT:
        return four_quadrant_thrust(n, inflow, k, p)
    if p.screw_model[k] == DISC:
        if n < 0.0:
            return -disc_thrust(-n, -inflow, k, p)
        return disc_thrust(n, inflow, k, p)
    d = p.screw_diameter[k]
    square = p.water_density * d**4 * p.screw_bollard[k]
    return square * abs(n) * (n - inflow / (d * p.screw_pitch[k]))


@compiled
def place_between(value: float, numbers: Any, first: int, count: int) -> tuple[int, float]:
    """The piece of increasing knots that a value falls into, and its share [1] of it; at its ends beyond.

    The knots: `count` of the numbers, from `first` on.
    """
    piece = 0
    while piece < count - 2 and value > numbers[first + piece + 1]:
        piece += 1
    if count < 2:
        return 0, 0.0
    low = numbers[first + piece]
    share = (value - low) / (numbers[first + piece + 1] - low)
    return piece, min(max(share, 0.0), 1.0)


@compiled
def table_thrust(throttle: float, inflow: float, k: int, p: Any) -> float:
    """Thrust [N] of a measured table, bilinear, constant beyond its speeds.

    The thruster's numbers: the throttles, the speeds, the thrust at each speed for each throttle.
    """
    throttles, speeds, numbers = int(p.table_throttles[k]), int(p.table_speeds[k]), p.screw_numbers[k]
    i, x = place_between(throttle, numbers, 0, throttles)
    j, y = place_between(inflow, numbers, throttles, speeds)
    beside, first = min(j + 1, speeds - 1), throttles + speeds + i * speeds
    second = first + speeds
    low = numbers[first + j] + y * (numbers[first + beside] - numbers[first + j])
    high = numbers[second + j] + y * (numbers[second + beside] - numbers[second + j])
    return low + x * (high - low)


@compiled
def thrust_at(throttle: float, inflow: float, k: int, p: Any) -> float:
    """Thrust [N] of thruster k, one with a propeller or a table, at a throttle [1] and V_a [m/s]."""
    if p.screw_model[k] == TABLE:
        return table_thrust(throttle, inflow, k, p)
    most = p.revolutions_max[k] if throttle >= 0.0 else p.revolutions_max_astern[k]
    return propeller_thrust(throttle * most, inflow, k, p)


@compiled
def flow_at(angle: float, u: float, v: float, r: float, k: int, p: Any) -> tuple[float, float]:
    """V_a along the direction `angle` [rad] of the thrust of thruster k, V_t across it [m/s].

    u, v [m/s], r [rad/s]: of the boat through the water; the wake slows down the water from ahead.
    """
    u_there, v_there = u - r * p.thruster_y[k], v + r * p.thruster_x[k]
    along = u_there * math.cos(angle) + v_there * math.sin(angle)
    across = v_there * math.cos(angle) - u_there * math.sin(angle)
    return (along * (1.0 - p.screw_wake[k]) if along > 0.0 else along), across


@compiled
def race_of(thrust: float, inflow: float, area: float, p: Any) -> float:
    """Δ_v = √(V_a² + 2T/(ρ A)) − V_a [m/s] behind a disc that pushes ahead (9), else 0."""
    if thrust <= 0.0:
        return 0.0
    ahead = max(inflow, 0.0)
    return math.sqrt(ahead * ahead + 2.0 * thrust / (p.water_density * area)) - ahead


@compiled
def crossflow_left(thrust: float, across: float, k: int, p: Any) -> float:
    """k_f = exp(−c V_t² ρ A/|T|) [1], V_j² = |T|/(ρ A) (24)."""
    if p.screw_crossflow[k] == 0.0 or across == 0.0:
        return 1.0
    if thrust == 0.0:
        return 0.0
    ratio = across * across * p.water_density * p.nozzle_area[k] / abs(thrust)
    return math.exp(-p.screw_crossflow[k] * ratio)
