"""Advance and tactical diameter of a turn (ITTC 7.5-04-02-01), from a track measured or simulated."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Turn:
    """advance [m]: way along the first heading when it has changed by 90 degrees; tactical_diameter [m]: way
    across it at 180; NaN where the boat did not turn so far."""

    advance: float
    tactical_diameter: float


def turn_of(pose: NDArray[np.float64]) -> Turn:
    """Figures of the turn in poses (T, 3): north, east [m], heading [rad]; rudder put over at the first.

    To starboard or to port alike; raw, with whatever wind and current made of it.
    """
    north, east = pose[:, 0] - pose[0, 0], pose[:, 1] - pose[0, 1]
    cos, sin = np.cos(pose[0, 2]), np.sin(pose[0, 2])
    turned = np.unwrap(pose[:, 2]) - pose[0, 2]
    side = np.sign(turned[-1])
    advance = _where(side * turned, 0.5 * np.pi, north * cos + east * sin)
    return Turn(advance, _where(side * turned, np.pi, side * (east * cos - north * sin)))


def _where(turned: NDArray[np.float64], angle: float, way: NDArray[np.float64]) -> float:
    reached = np.flatnonzero(turned >= angle)
    if len(reached) == 0:
        return float("nan")
    i = int(reached[0])
    if i == 0:
        return float(way[0])
    share = (angle - turned[i - 1]) / (turned[i] - turned[i - 1])
    return float(way[i - 1] + share * (way[i] - way[i - 1]))
