"""Positions in degrees that are taken for metres."""

import numpy as np
from numpy.typing import ArrayLike

MOST_LATITUDE, MOST_LONGITUDE = 90.0, 180.0
"""Degrees."""
LARGEST_SPAN = 0.02
"""Degrees: some 2 km. Positions in metres that span less are of a boat at rest."""
LEAST_DISTANCE = 100.0
"""Spans from the origin of the axes to a track in degrees; a local frame has its origin near the track."""
METRES_PER_DEGREE = 111_195.0
"""Of latitude, on a sphere of 6371 km."""


def in_degrees(first: ArrayLike, second: ArrayLike) -> bool:
    """Whether two coordinates (T,) of a position have the size of latitude and longitude, in either order.

    Rows without a number are left out.
    """
    both = np.array([first, second], float)
    known = both[:, np.isfinite(both).all(axis=0)]
    if not known.size:
        return False
    nearer, farther = np.sort(np.abs(np.median(known, axis=1)))
    span = float(np.ptp(known, axis=1).max())
    return bool(
        nearer <= MOST_LATITUDE
        and farther <= MOST_LONGITUDE
        and 0.0 < span <= LARGEST_SPAN
        and nearer >= LEAST_DISTANCE * span
    )
