"""Velocity triangles of an impeller, the slip at its outlet, and the vane's mean line (thesis 5.3.1)."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Streamline = Literal["tip", "mean", "root"]
STREAMLINES: tuple[Streamline, ...] = ("tip", "mean", "root")


@dataclass(frozen=True)
class Triangle:
    """Speeds [m/s] where a streamline meets an edge of the vane, at a radius [m].

    blade u: of the vane; meridian c_m: of the water along the meridian; whirl c_u: of the water, tangential.
    """

    streamline: Streamline
    radius: float
    blade: float
    meridian: float
    whirl: float

    @property
    def relative_whirl(self) -> float:
        """w_u = u − c_u [m/s] (5.18, 5.24)."""
        return self.blade - self.whirl

    @property
    def absolute(self) -> float:
        """c = √(c_m² + c_u²) [m/s] (5.25)."""
        return math.hypot(self.meridian, self.whirl)

    @property
    def relative(self) -> float:
        """w = √(c_m² + w_u²) [m/s]: (5.26) misprints c_2m for c_m2, the paper's (27) is right."""
        return math.hypot(self.meridian, self.relative_whirl)

    @property
    def angle(self) -> float:
        """β = atan(c_m / w_u) [rad] (5.29, 5.30)."""
        return math.atan2(self.meridian, self.relative_whirl)


def free_vortex_triangle(
    streamline: Streamline, radius: float, mean_radius: float, turning: float, meridian: float, whirl: float
) -> Triangle:
    """The triangle at a radius [m] of a free vortex, r c_u constant, whose mean radius has the given `whirl`.

    turning: of the impeller [rad/s]; meridian: c_m [m/s], the same over the edge.
    """
    return Triangle(streamline, radius, turning * radius, meridian, whirl * mean_radius / radius)


def slip_factor(outlet: Triangle, blades: int) -> float:
    """Stodola's σ = 1 − π sin β_2 / (z (1 − (c_m2/u_2) cot β_2)) (5.27).

    1 − (c_m2/u_2) cot β_2 is c_u2/u_2 of the vane's own angle. The thesis multiplies c_u2 by σ (5.28) but
    prints β_2 without it.
    """
    across = 1.0 - outlet.meridian / outlet.blade / math.tan(outlet.angle)
    return 1.0 - math.pi * math.sin(outlet.angle) / (blades * across)


@dataclass(frozen=True)
class MeanLine:
    """A vane's mean line on the surface of revolution of a streamline, from inlet to outlet.

    radius, height [m] above the tip's inlet, angle [rad] about the axis, length [m] along the meridian, vane
    [rad]: its angle β; each a vector of equal length.
    """

    radius: NDArray[np.float64]
    height: NDArray[np.float64]
    angle: NDArray[np.float64]
    length: NDArray[np.float64]
    vane: NDArray[np.float64]

    @property
    def wrap(self) -> float:
        """Angle about the axis [rad] from inlet to outlet."""
        return float(self.angle[-1])


def mean_line(inlet: Triangle, outlet: Triangle, heights: tuple[float, float], points: int = 60) -> MeanLine:
    """The mean line between two triangles at two heights [m]: dθ = dm / (r tan β).

    The meridian is straight and β changes linearly along it: both ours, the thesis prints neither.
    """
    share = np.linspace(0.0, 1.0, points)
    radius = inlet.radius + share * (outlet.radius - inlet.radius)
    height = heights[0] + share * (heights[1] - heights[0])
    length = share * math.hypot(outlet.radius - inlet.radius, heights[1] - heights[0])
    vane = inlet.angle + share * (outlet.angle - inlet.angle)
    slope = 1.0 / (radius * np.tan(vane))
    steps = 0.5 * (slope[1:] + slope[:-1]) * np.diff(length)
    return MeanLine(radius, height, np.concatenate([[0.0], np.cumsum(steps)]), length, vane)
