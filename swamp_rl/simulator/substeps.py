"""How finely the motion of a boat is integrated."""

import math

from swamp_rl.boat import Boat
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.step import SUBSTEP

OF_TIME = 0.22
"""Largest step in units of the boat's time L / U: at 0.22 a boat of 1 m is off by 0.2 % of its length after
thirty lengths under random throttles."""


SLACK = 0.01
"""Share by which a step may be longer than the longest: the sample step of a log is rounded."""


def substeps_of(dt: float, boat: Boat) -> int:
    """Runge-Kutta steps that a control step of dt [s] is divided into."""
    return substeps_in(dt, longest_substep(boat))


def longest_substep(boat: Boat) -> float:
    """The longest Runge-Kutta step [s] of a boat."""
    return min(SUBSTEP, OF_TIME * reference_of(boat).time)


def substeps_in(dt: float, longest: float) -> int:
    """Equal steps that a control step of dt [s] is divided into, at most `longest` [s] but for `SLACK`."""
    return max(1, math.ceil(dt / (longest * (1.0 + SLACK))))


def steps_over(seconds: float, dt: float) -> int:
    """Steps of dt [s] that cover `seconds`, but for `SLACK` of the last one: both numbers are rounded."""
    return math.ceil(seconds / dt - SLACK)
