"""Angles brought back into one turn, and plane vectors turned by an angle."""

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

FULL_TURN = 2.0 * math.pi  # to which the remainder of a negative rounding error is rounded up
Angle = TypeVar("Angle", float, NDArray[np.float64])


def turned(x: Angle, y: Angle, angle: Angle) -> tuple[Angle, Angle]:
    """x cos − y sin and x sin + y cos of an angle [rad].

    By the heading, ahead and starboard become north and east; by minus the heading, the other way round.
    """
    cos, sin = np.cos(angle), np.sin(angle)
    return x * cos - y * sin, x * sin + y * cos


def wrapped(angle: Angle) -> Angle:
    """The same direction [rad] in (−π, π]."""
    back = (math.pi - angle) % FULL_TURN
    return math.pi - back * (back < FULL_TURN)


def wrapped_below(angle: Angle) -> Angle:
    """The same direction [rad] in [−π, π): straight astern is −π."""
    on = (angle + math.pi) % FULL_TURN
    return on * (on < FULL_TURN) - math.pi


def within_half_turn(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same direction [rad] in [−π, π]; what lies there already stays as it is to the last bit."""
    back = angle - FULL_TURN * np.round(angle / FULL_TURN)
    return np.clip(back, -np.pi, np.pi)
