"""The shapes drawn: the boat's outline on a chart, and its hull or hulls, deck and mast as a mesh."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

OUTLINE = np.array([[-0.5, -0.5], [0.25, -0.5], [0.5, 0.0], [0.25, 0.5], [-0.5, 0.5]])
"""(5, 2) ahead in lengths and to starboard in breadths, with a bow to tell it from the stern."""

HULL_BREADTH = 0.26
"""Of one of the two hulls, as a share of the boat's breadth."""

BROAD = 0.5
"""A boat broader than that, in lengths, is drawn with two hulls."""


def corners(pose: Array, length: float, breadth: float) -> Array:
    """(T, 6, 2) the closed outline's north and east [m] at each pose (T, 3)."""
    ahead, starboard = (np.vstack([OUTLINE, OUTLINE[:1]]) * (length, breadth)).T
    cos, sin = np.cos(pose[:, 2])[:, None], np.sin(pose[:, 2])[:, None]
    north = pose[:, :1] + ahead * cos - starboard * sin
    east = pose[:, 1:2] + ahead * sin + starboard * cos
    return np.stack([north, east], axis=-1)


def mesh(length: float, breadth: float) -> tuple[Array, NDArray[np.uint32]]:
    """Vertices (n, 3) ahead, to port and up [m] from midship at the water, and triangles (m, 3)."""
    low, deck, top, mast = (share * length for share in (-0.05, 0.16, 0.22, 0.7))
    if breadth > BROAD * length:
        width, middle = HULL_BREADTH * breadth, 0.5 * (1.0 - HULL_BREADTH) * breadth
        hulls = [OUTLINE * (length, width) + (0.0, side * middle) for side in (-1, 1)]
    else:
        hulls = [OUTLINE * (length, breadth)]
    plate = np.array([[-0.3, -0.5], [0.15, -0.5], [0.15, 0.5], [-0.3, 0.5]]) * (length, 0.95 * breadth)
    stick = np.array([[-0.15, -0.03], [-0.09, -0.03], [-0.09, 0.03], [-0.15, 0.03]]) * length
    parts = [*(prism(hull, low, deck) for hull in hulls), prism(plate, deck, top), prism(stick, top, mast)]
    first = np.cumsum([0, *(len(vertices) for vertices, _ in parts[:-1])])
    triangles = np.vstack([faces + start for (_, faces), start in zip(parts, first, strict=True)])
    return np.vstack([vertices for vertices, _ in parts]), triangles.astype(np.uint32)


def prism(outline: Array, low: float, high: float) -> tuple[Array, NDArray[Any]]:
    """A convex outline (n, 2) of ahead and starboard [m], upright between two heights; every face its own
    vertices, so that its edges are sharp."""
    n = len(outline)
    flat = outline * (1.0, -1.0)
    ends = [np.column_stack([flat, np.full(n, height)]) for height in (low, high)]
    fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
    vertices, faces = [ends[0], ends[1]], [fan, fan + n]
    for i in range(n):
        j = (i + 1) % n
        faces.append(np.array([[0, 1, 2], [0, 2, 3]]) + 2 * n + 4 * i)
        vertices.append(np.array([ends[0][i], ends[0][j], ends[1][j], ends[1][i]]))
    return np.vstack(vertices), np.vstack(faces)
