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
    """Whether two coordinates (T,), (S,) of a position have the size of latitude and longitude, in either
    order. What is no number is left out.
    """
    known = [np.asarray(one, float)[np.isfinite(one)] for one in (first, second)]
    if not all(map(len, known)):
        return False
    nearer, farther = sorted(abs(float(np.median(one))) for one in known)
    span = max(float(np.ptp(one)) for one in known)
    return bool(
        nearer <= MOST_LATITUDE
        and farther <= MOST_LONGITUDE
        and 0.0 < span <= LARGEST_SPAN
        and nearer >= LEAST_DISTANCE * span
    )
