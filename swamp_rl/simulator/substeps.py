"""How finely the motion of a boat is integrated."""

import math

from swamp_rl.boat import Boat
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.step import SUBSTEP

# Of a boat's time L / U, at most: it goes so much of its length, and is off by some thousandths of it after
# thirty lengths of hard steering.
OF_TIME = 0.22


def longest_substep(boat: Boat) -> float:
    """The longest Runge-Kutta step [s] of a boat."""
    return min(SUBSTEP, OF_TIME * reference_of(boat).time)


def substeps_of(dt: float, boat: Boat) -> int:
    """Runge-Kutta steps that a control step of dt [s] is divided into."""
    return max(1, math.ceil(dt / longest_substep(boat) - 1e-9))
