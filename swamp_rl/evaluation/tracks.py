"""How far tracks lie from each other, and whether a place is where none of them has been."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POINTS = 60


def along(track: Array, points: int = POINTS) -> Array:
    """The places (points, 2) [m] at equal shares of the way of a track (T, 2 or more), north, east first."""
    place = np.asarray(track, dtype=float)[:, :2]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(place, axis=0).T))])
    if way[-1] == 0.0:
        return np.repeat(place[:1], points, axis=0)
    at = np.linspace(0.0, way[-1], points)
    return np.stack([np.interp(at, way, place[:, 0]), np.interp(at, way, place[:, 1])], axis=1)


def distances(a: Sequence[Array], b: Sequence[Array]) -> Array:
    """(A, B) mean distances [m] of tracks at equal shares of their ways; each track (T, 2 or more).

    Blind to how fast a track was sailed; 0 only for the same track.
    """
    first, second = (np.array([along(one) for one in tracks]).reshape(-1, POINTS, 2) for tracks in (a, b))
    gap = first[:, None] - second[None, :]
    return np.hypot(gap[..., 0], gap[..., 1]).mean(axis=-1)


def nearest_of_fewer(table: Array) -> Array:
    """(A,) distance to the nearest of B - 1 tracks, from distances (A, B): the mean over leaving out each.

    So that it compares with the nearest of the others among those B tracks themselves, of which there are
    B - 1. ValueError for fewer than two.
    """
    if table.shape[1] < 2:
        raise ValueError("at least two tracks are needed to leave one out")
    two = np.sort(table, axis=1)[:, :2]
    return two[:, 0] + (two[:, 1] - two[:, 0]) / table.shape[1]


def nearest_other(table: Array) -> Array:
    """(B,) distance of each track to the nearest other one, from distances (B, B) among themselves."""
    others = np.where(np.eye(len(table), dtype=bool), np.inf, table)
    return others.min(axis=1)


def mean_other(table: Array) -> Array:
    """(B,) mean distance of each track to the others, from distances (B, B) among themselves; NaN for one."""
    if len(table) < 2:
        return np.full(len(table), np.nan)
    return table.sum(axis=1) / (len(table) - 1)


def outside(places: Array, tracks: Sequence[Array]) -> NDArray[np.bool_]:
    """(n,) whether places (n, 2) [m] lie outside the convex hull of all points of tracks (T, 2 or more)."""
    from scipy.spatial import ConvexHull

    edges = ConvexHull(np.concatenate([np.asarray(track)[:, :2] for track in tracks])).equations
    return (np.asarray(places) @ edges[:, :2].T + edges[:, 2] > 0.0).any(axis=1)
