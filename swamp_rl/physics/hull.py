"""Hydrodynamic forces on the hull, on velocities relative to the water (thesis eq. 8.16, after Yoshimura)."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled
from swamp_rl.physics.resistance import Tow, surge_resistance


@compiled
def crossflow_integrals(a: float, b: float, length: float) -> tuple[float, float]:
    """Integrals over the hull of |w| w and |w| w x, with w = a + b x and x from -length/2 to length/2.

    The closed form of the cross-flow drag in eq. 8.16; a [m/s] is the sway, b [1/s] the scaled yaw rate.
    Where w keeps its sign along the hull the integrand is a polynomial; elsewhere it has one root inside.
    Both branches agree where they meet, with their first derivatives.
    """
    half = 0.5 * b * length
    if abs(a) >= abs(half):
        sign = math.copysign(1.0, a)
        return sign * length * (a * a + half * half / 3.0), sign * a * b * length**3 / 6.0
    q2 = (a / half) ** 2
    force = a * length * abs(half) * (1.0 + q2 / 3.0)
    moment = 0.25 * length**2 * half * abs(half) * (0.5 + q2 - q2 * q2 / 6.0)
    return force, moment


@compiled
def demihull_resistance(u: float, v: float, r: float, p: Any, tank: Any, tow: Tow) -> tuple[float, float]:
    """Surge force [N] and yaw moment [N m] of the resistance of two demihulls, `hull_spacing` S [m] apart.

    Each meets its own surge speed and carries half of the resistance X_R of the whole boat:
    X = ½ Σ X_R(u − r y_i, v), N = −½ Σ y_i X_R(u − r y_i, v), y_i = ±S/2. At r = 0, or with S = 0, it is the
    resistance at midship. tow: `towing(p, tank)`.
    """
    if p.hull_spacing == 0.0:  # the same number, computed once
        return surge_resistance(u, v, p, tank, tow), 0.0
    offset = 0.5 * p.hull_spacing
    difference = r * offset
    starboard = 0.5 * surge_resistance(u - difference, v, p, tank, tow)
    port = 0.5 * surge_resistance(u + difference, v, p, tank, tow)
    return starboard + port, offset * (port - starboard)


@compiled
def hull_forces(u: float, v: float, r: float, p: Any, tank: Any, tow: Tow) -> tuple[float, float, float]:
    """Surge force, sway force [N] and yaw moment [N m] on the hull (eq. 8.16); tow: `towing(p, tank)`.

    X_H = X_R + q X'_vr L v r − d u,  N_R: `demihull_resistance`, q = ½ ρ L d
    Y_H = q [Y'_v v |u| + Y'_r L r u − (k C_D/L) ∫ |v + C_rY r x| (v + C_rY r x) dx] − d_v v
    N_H = q L [N'_v v u + N'_r L r |u| − (C_D/L²) ∫ |v + C_rN r x| (v + C_rN r x) x dx] + N_R + a u |u|
          − d_r r
    The linear damping d, d_v [N s/m], d_r [N m s/rad] (−X_u, −Y_v and −N_r of Fossen 2021, which count near
    rest) and the asymmetry a [N m s²/m²] are zero for the boat as designed.
    k is `port_drag` while the hull goes to port, v < 0, where the integral is negative too, and 1 otherwise.
    """
    length = p.length
    q = 0.5 * p.water_density * length * p.draught
    drag = p.c_d
    y_integral, n_integral = crossflow_integrals(v, p.c_ry * r, length)
    if p.c_rn != p.c_ry:
        _, n_integral = crossflow_integrals(v, p.c_rn * r, length)
    resistance, turning_resistance = demihull_resistance(u, v, r, p, tank, tow)
    surge = resistance + q * p.x_vr * length * v * r - p.linear_drag * u
    across = drag / length
    across = across * p.port_drag if v < 0.0 else across
    # Each sum begins with what is known first: the integrals and the resistance take longest.
    linear = p.linear_sway_damping / q * v
    sway = q * (p.y_v * v * abs(u) + p.y_r * length * r * u - linear - across * y_integral)
    yaw = q * length * (p.n_v * v * u + p.n_r * length * r * abs(u) - drag / (length * length) * n_integral)
    yaw = yaw + turning_resistance + (p.asymmetry_yaw * u * abs(u) - p.linear_yaw_damping * r)
    return surge, sway, yaw
