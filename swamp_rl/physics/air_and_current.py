"""Forces of the wind (thesis 8.17 to 8.19) and of the thesis's own current model (8.20 to 8.22)."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled


@compiled
def wind_forces(ahead: float, starboard: float, p: Any) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of the apparent wind (8.17 to 8.19).

    X = −½ ρ_a V² A_F c_x cos a,  Y = −½ ρ_a V² A_L c_y sin a,  N = Y (x_L + c_n (1 − 2 |a|/π) L)

    ahead, starboard [m/s]: components of where the apparent wind comes from. A wind from starboard pushes
    to port: the source's Y has y to port, hence the minus sign here.
    """
    pressure = 0.5 * p.air_density * math.sqrt(ahead * ahead + starboard * starboard)
    surge = -pressure * p.air_frontal_area * p.air_c_x * ahead
    sway = -pressure * p.air_lateral_area * p.air_c_y * starboard
    from_bow = abs(math.atan2(starboard, ahead))
    lever = p.air_lateral_centre + p.air_c_n * (1.0 - 2.0 * from_bow / math.pi) * p.length
    return surge, sway, sway * lever


@compiled
def wind_push(
    u: float, v: float, wind_ahead: float, wind_starboard: float, p: Any
) -> tuple[float, float, float]:
    """Force and moment that a wind adds to those of calm air: F(u + w_u, v + w_v) − F(u, v), F `wind_forces`.

    u, v: the boat's velocity over ground, wind_ahead, wind_starboard: components of where the wind comes from
    [m/s]. Decision: what F gives for the boat's own speed is taken off, since the towing tank's resistance
    holds it already; so the push is zero, and continuous, where the wind is zero.
    """
    windy = wind_forces(u + wind_ahead, v + wind_starboard, p)
    calm = wind_forces(u, v, p)
    return windy[0] - calm[0], windy[1] - calm[1], windy[2] - calm[2]


@compiled
def current_forces(ahead: float, starboard: float, p: Any) -> tuple[float, float, float]:
    """Force and moment of a flow on the underwater hull in DNV's form (8.20 to 8.22).

    X = −½ ρ V² A_F c_x cos a,  Y = −½ ρ V² A_L c_y sin a,  N = Y (x_L + l(a) L)
    with a the direction that the flow comes from and l = 0.4 (1 − 2 |a|/π) within [−0.2, 0.25].
    ahead, starboard [m/s]: components of where the apparent current comes from.
    """
    pressure = 0.5 * p.water_density * math.sqrt(ahead * ahead + starboard * starboard)
    surge = -pressure * p.current_frontal_area * p.current_c_x * ahead
    sway = -pressure * p.current_lateral_area * p.current_c_y * starboard
    from_bow = abs(math.atan2(starboard, ahead))
    relative_lever = max(min(0.4 * (1.0 - 2.0 * from_bow / math.pi), 0.25), -0.2)
    return surge, sway, sway * (p.current_lateral_centre + relative_lever * p.length)


@compiled
def current_push(
    u: float, v: float, current_ahead: float, current_starboard: float, p: Any
) -> tuple[float, float, float]:
    """Extra force of a current, `model: dnv_force`: F(u − u_c, v − v_c) − F(u, v), F by `current_forces`.

    u, v: the boat's velocity over ground, current_ahead, current_starboard: the current's components [m/s].
    The thesis applies F to the relative speed alone. Decision: what F gives for the boat's own speed is taken
    off, since the towing tank's resistance holds it already; so the push is zero, and continuous, where the
    current is zero.
    """
    moving = current_forces(u - current_ahead, v - current_starboard, p)
    still = current_forces(u, v, p)
    return moving[0] - still[0], moving[1] - still[1], moving[2] - still[2]
