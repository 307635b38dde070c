"""A plane curve by its vertices: arc length, course and curvature, and the nearest point of it."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Nearest(NamedTuple):
    """The nearest point of a curve, `along` from its start, and the place `across` to starboard of it [m];
    past the end of the curve that to starboard of the line in the direction of the end.
    """

    along: float
    across: float


@dataclass(frozen=True)
class Curve:
    """n vertices, joined by straight lines.

    places: (n, 2) north, east [m]; course: (n,) direction [rad], not wrapped; curvature: (n,) [1/m], positive
    to starboard; along: (n,) arc length [m]. A corner has two vertices at one place.
    """

    places: Array
    course: Array
    curvature: Array
    along: Array

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return float(self.along[-1])

    def course_at(self, along: float) -> float:
        """Direction [rad]."""
        return float(np.interp(along, self.along, self.course))

    def curvature_at(self, along: float) -> float:
        """Curvature [1/m]."""
        return float(np.interp(along, self.along, self.curvature))

    def nearest(self, north: float, east: float, since: float, ahead: float) -> Nearest:
        """The nearest point between `since` and `since + ahead` [m] along the curve.

        A curve may cross itself: which of its branches is meant is decided by how far the boat has come.
        """
        low = max(int(np.searchsorted(self.along, since, "right")) - 1, 0)
        high = min(int(np.searchsorted(self.along, since + ahead, "left")), len(self.along) - 1)
        start, step = self.places[low:high], np.diff(self.places[low : high + 1], axis=0)
        size = np.diff(self.along[low : high + 1])
        whole = size > 0.0
        if not whole.any():
            return self._seen_from_end(north, east)
        start, step, size, base = start[whole], step[whole], size[whole], self.along[low:high][whole]
        away = np.array([north, east]) - start
        way = (away * step).sum(axis=1) / size
        way = np.clip(way, np.maximum(since - base, 0.0), np.minimum(since + ahead - base, size))
        distance = np.hypot(*(away - step * (way / size)[:, None]).T)
        i = int(np.argmin(distance))
        if high == len(self.along) - 1 and i == len(size) - 1 and way[i] == size[i]:
            return self._seen_from_end(north, east)
        across = (step[i, 0] * away[i, 1] - step[i, 1] * away[i, 0]) / size[i]
        return Nearest(float(base[i] + way[i]), float(math.copysign(distance[i], across)))

    def _seen_from_end(self, north: float, east: float) -> Nearest:
        away = np.array([north, east]) - self.places[-1]
        across = math.cos(self.course[-1]) * away[1] - math.sin(self.course[-1]) * away[0]
        return Nearest(self.length, float(across))


def joined(parts: list[tuple[Array, Array, Array]]) -> Curve:
    """One curve of parts (places, course, curvature), each beginning where the one before it ends."""
    places, course, curvature = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    return Curve(places, np.unwrap(course), curvature, along)


def progress(curve: Curve, track: Array, ahead: float) -> Array:
    """(T, 2) `Nearest` of each row of a track (T, 2), never going back along the curve."""
    found, since = [], 0.0
    for north, east in track.tolist():
        near = curve.nearest(north, east, since, ahead)
        found.append(near)
        since = near.along
    return np.array(found)
