"""How a fixed thruster obeys throttle and steering: ahead, astern or not, and which way it turns the boat."""

import math

from swamp_rl.boat.schema import Thruster

ABEAM = math.cos(math.radians(75.0))
"Share of a push that goes ahead, below which a fixed thruster pushes across, as a tunnel thruster does."


def fixed_lever(thruster: Thruster) -> tuple[float, float]:
    """Signs (ahead, turn) of a fixed thruster: of the throttle that pushes ahead, 0 for one that pushes
    across, and of the throttle that turns the bow to starboard, 0 for one that does not turn the boat.
    """
    cos, sin = math.cos(thruster.azimuth_min), math.sin(thruster.azimuth_min)
    moment = round(thruster.x * sin - thruster.y * cos, 6)
    return math.copysign(1.0, cos) if abs(cos) >= ABEAM else 0.0, float((moment > 0.0) - (moment < 0.0))
