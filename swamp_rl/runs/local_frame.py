"""Latitude and longitude on the WGS84 ellipsoid as metres to the north and east of an origin."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.extras import missing

Array = NDArray[np.float64]
Place = tuple[float, float]
"""Latitude and longitude [degrees]."""
NEAR = 10_000.0
"""m from the origin within which the plane serves as a local frame: distances as `to_local` has them, north
of the plane within 0.16 degrees of true north at latitudes up to 60 degrees."""


GEODETIC = "latitude", "longitude"
"""Columns in degrees that an import keeps beside north and east."""


def to_local(latitude: Array, longitude: Array, origin: Place) -> tuple[Array, Array]:
    """North and east [m] of places [degrees] by the azimuthal equidistant projection about `origin`.

    Distance and direction from the origin are exact on the ellipsoid; within NEAR of it, distances between
    other places are so to less than a millimetre in a kilometre. UserError without pyproj.
    """
    east, north = _plane(origin)(np.asarray(longitude, float), np.asarray(latitude, float))
    return np.asarray(north, float), np.asarray(east, float)


def from_local(north: Array, east: Array, origin: Place) -> tuple[Array, Array]:
    """Latitude and longitude [degrees] of places [m]: the inverse of `to_local`. UserError without pyproj."""
    longitude, latitude = _plane(origin)(np.asarray(east, float), np.asarray(north, float), inverse=True)
    return np.asarray(latitude, float), np.asarray(longitude, float)


def distance(place: Place, origin: Place) -> float:
    """Distance [m] of a place from an origin on the ellipsoid. UserError without pyproj."""
    north, east = to_local(np.array([place[0]]), np.array([place[1]]), origin)
    return float(np.hypot(north[0], east[0]))


def origin_of(entries: Mapping[str, Any]) -> Place | None:
    """The origin in the entries of a run, where they have one."""
    match entries.get("origin"):
        case {"latitude": float(latitude), "longitude": float(longitude)}:
            return latitude, longitude
    return None


@lru_cache(maxsize=8)
def _plane(origin: Place) -> Any:
    try:
        from pyproj import Proj
    except ImportError as error:
        raise missing("latitude and longitude need pyproj", "gps") from error
    return Proj(proj="aeqd", ellps="WGS84", lat_0=origin[0], lon_0=origin[1])
