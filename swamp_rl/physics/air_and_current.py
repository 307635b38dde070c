"""Forces of the wind (thesis 8.17 to 8.19) and of the thesis's own current model (8.20 to 8.22)."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled


@compiled
def wind_forces(ahead: float, starboard: float, p: Any) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of the apparent wind (8.17 to 8.19).

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
def current_forces(ahead: float, starboard: float, p: Any) -> tuple[float, float, float]:
    """Extra force of the current in the thesis's DNV form (8.20 to 8.22), for `model: dnv_force` only.

    ahead, starboard [m/s]: components of where the apparent current comes from.
    """
    pressure = 0.5 * p.water_density * math.sqrt(ahead * ahead + starboard * starboard)
    surge = -pressure * p.current_frontal_area * p.current_c_x * ahead
    sway = -pressure * p.current_lateral_area * p.current_c_y * starboard
    from_bow = abs(math.atan2(starboard, ahead))
    relative_lever = max(min(0.4 * (1.0 - 2.0 * from_bow / math.pi), 0.25), -0.2)
    return surge, sway, sway * (p.current_lateral_centre + relative_lever * p.length)
