"""How near a track came to the buoys, by the geometry that decides whether one was touched."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.course.geometry import squared_distance_to_way
from swamp_rl.course.schema import Course
from swamp_rl.course.tables import buoy_table


def closest_buoy(track: NDArray[np.float64], course: Course, breadth: float) -> float:
    """Least clearance [m] between the hull, a disc of `breadth` [m], and any buoy, negative where they met.

    track: north and east [m] of midship, (T, 2 or more), T at least 2.
    """
    buoys, places = buoy_table(course).tolist(), np.asarray(track)[:, :2].tolist()
    nearest = min(
        squared_distance_to_way(*before, *after, *buoy)
        for before, after in pairwise(places)
        for buoy in buoys
    )
    return math.sqrt(nearest) - course.buoy_radius - 0.5 * breadth
