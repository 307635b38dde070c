"""Angles brought back into one turn, and plane vectors turned by an angle."""

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Angle = TypeVar("Angle", float, NDArray[np.float64])


def turned(x: Angle, y: Angle, angle: Angle) -> tuple[Angle, Angle]:
    """x cos − y sin and x sin + y cos of an angle [rad].

    By the heading, ahead and starboard become north and east; by minus the heading, the other way round.
    """
    cos, sin = np.cos(angle), np.sin(angle)
    return x * cos - y * sin, x * sin + y * cos


def wrapped(angle: Angle) -> Angle:
    """The same direction [rad] in (−π, π]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)


def wrapped_below(angle: Angle) -> Angle:
    """The same direction [rad] in [−π, π): straight astern is −π."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def within_half_turn(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same direction [rad] in [−π, π]; what lies there already stays as it is to the last bit."""
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))
