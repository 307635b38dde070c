"""Logs of a twin-thruster boat on a weaving course, scripted, and what they say in our columns."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ORIGIN = (44.3, 9.15)
"""Latitude and longitude [degrees] of the first row."""
START = 1_700_000_000.0
"""s since 1970."""
RATE = 10.0


def weaving(seconds: float = 30.0, rate: float = RATE) -> dict[str, Array]:
    """SI columns of a boat that weaves at about 1 m/s, with its two throttles."""
    time = np.arange(round(seconds * rate) + 1) / rate
    heading, surge = _weave(time)
    fine = np.arange(0.0, seconds + 0.02, 0.01)
    psi, speed = _weave(fine)
    north, east = (np.interp(time, fine, np.cumsum(speed * f(psi)) * 0.01) for f in (np.cos, np.sin))
    turn = 0.3 * np.cos(0.4 * time)
    return {
        "time": time,
        "north": north - north[0],
        "east": east - east[0],
        "heading": heading,
        "surge": surge,
        "sway": 0.05 * np.cos(0.4 * time),
        "yaw_rate": 0.24 * np.cos(0.4 * time),
        "throttle_port": 0.5 + turn,
        "throttle_starboard": 0.5 - turn,
    }


def _weave(time: Array) -> tuple[Array, Array]:
    return 0.6 * np.sin(0.4 * time) + 0.3, 1.0 + 0.2 * np.sin(0.25 * time)


def geodetic(run: dict[str, Array]) -> tuple[Array, Array]:
    """Latitude and longitude [degrees] of the run's places, by the projection that importing inverts."""
    from pyproj import Proj

    plane = Proj(proj="aeqd", ellps="WGS84", lat_0=ORIGIN[0], lon_0=ORIGIN[1])
    longitude, latitude = plane(run["east"], run["north"], inverse=True)
    return np.asarray(latitude), np.asarray(longitude)


def stranger_columns(run: dict[str, Array]) -> dict[str, list[str]]:
    """The run as a logger of its own wrote it: epoch ms, degrees, microseconds of pulse width, words."""
    latitude, longitude = geodetic(run)
    return {
        "epoch_ms": [str(round(1000.0 * (START + t))) for t in run["time"]],
        "lat": [f"{value:.9f}" for value in latitude],
        "lon": [f"{value:.9f}" for value in longitude],
        "compass": [f"{value:.3f}" for value in np.mod(np.degrees(run["heading"]), 360.0)],
        "pwm_left": [f"{1500 + 400 * value:.2f}" for value in run["throttle_port"]],
        "pwm_right": [f"{1500 + 400 * value:.2f}" for value in run["throttle_starboard"]],
        "mode": ["MANUAL"] * len(run["time"]),
    }


def csv_of(path: Path, columns: dict[str, list[str]], drop: tuple[int, ...] = ()) -> Path:
    """Columns of text as a CSV file, without the rows `drop`."""
    rows = [",".join(row) for i, row in enumerate(zip(*columns.values(), strict=True)) if i not in drop]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    return path


MAP = [
    "time=epoch_ms",
    "latitude=lat",
    "longitude=lon",
    "heading=radians(compass)",
    "throttle_port=(pwm_left - 1500) / 400",
    "throttle_starboard=(pwm_right - 1500) / 400",
]
