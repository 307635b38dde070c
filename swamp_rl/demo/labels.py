"""Places of labels beside moving points, so that none covers another."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def apart(points: Array, sizes: Array, offset: Array) -> Array:
    """(N, 2) lower left corners of boxes of `sizes` (N, 2) beside `points` (N, 2), all in pixels.

    Each box lies at `offset` (2,) from its point, moved up or down by the least that clears those before it.
    """
    corners = np.empty((0, 2))
    for number, (point, size) in enumerate(zip(points, sizes, strict=True)):
        wanted = point + offset
        before = sizes[:number]
        beside = (corners[:, 0] < wanted[0] + size[0]) & (wanted[0] < corners[:, 0] + before[:, 0])
        low, high = corners[beside, 1] - size[1], corners[beside, 1] + before[beside, 1]
        heights = np.concatenate([[wanted[1]], low, high])  # as wanted, right below or above another
        free = [y for y in heights if not ((low < y) & (y < high)).any()]
        wanted[1] = min(free, key=lambda y: abs(y - wanted[1]))
        corners = np.vstack([corners, wanted])
    return corners
