"""Latitude and longitude on the WGS84 ellipsoid as metres to the north and east of an origin."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.extras import missing

Array = NDArray[np.float64]
Place = tuple[float, float]
"""Latitude and longitude [degrees]."""


def to_local(latitude: Array, longitude: Array, origin: Place) -> tuple[Array, Array]:
    """North and east [m] of places [degrees] by the azimuthal equidistant projection about `origin`.

    Distance and direction from the origin are exact on the ellipsoid; within 10 km of it, distances between
    other places are so to less than a millimetre in a kilometre. UserError without pyproj.
    """
    east, north = _plane(origin)(np.asarray(longitude, float), np.asarray(latitude, float))
    return np.asarray(north, float), np.asarray(east, float)


def from_local(north: Array, east: Array, origin: Place) -> tuple[Array, Array]:
    """Latitude and longitude [degrees] of places [m]: the inverse of `to_local`. UserError without pyproj."""
    longitude, latitude = _plane(origin)(np.asarray(east, float), np.asarray(north, float), inverse=True)
    return np.asarray(latitude, float), np.asarray(longitude, float)


@lru_cache(maxsize=8)
def _plane(origin: Place) -> Any:
    try:
        from pyproj import Proj
    except ImportError as error:
        raise missing("latitude and longitude need pyproj", "gps") from error
    return Proj(proj="aeqd", ellps="WGS84", lat_0=origin[0], lon_0=origin[1])
