"""The telemetry line of the sensors' program (thesis 6.2): written from a motion, and read back."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.runs.import_telemetry import FIELDS, VALID, WHOLE, velocity
from swamp_rl.runs.local_frame import Place, from_local, to_local

Array = NDArray[np.float64]

END = "\n\0"
"""Of every telemetry packet: a line feed for terminals, and the zero byte of a C string."""
CAMOGLI: Place = (44.3489, 9.1536)
"""Origin of north and east where none is given [degrees]: off the Rivo Giorgio pier of thesis 7.3.3, to about
100 m."""
FASTEST, QUICKEST = 100.0, 20.0
"""Over ground [m/s] and about the vertical [rad/s] that a reading is believed to."""
DECIMALS = {"latitude": 8, "longitude": 8}
"""Of numbers that are not whole; others have 6."""


def sensor_line(motion: Array, utc: int, sender: int, origin: Place, valid: bool = True) -> str:
    """The 40 fields for a motion (6,): north, east [m], heading [rad], surge, sway [m/s], yaw rate [rad/s].

    utc: µs since 1970. The boat lies level, at sea level, unaccelerated: only what the simulator knows is not
    constant. valid: whether the GPS has a fix.
    """
    north, east, heading, surge, sway, yaw_rate = motion.tolist()
    cos, sin = math.cos(heading), math.sin(heading)
    latitude, longitude = from_local(np.array([north]), np.array([east]), origin)
    over_ground = (surge * cos - sway * sin, surge * sin + sway * cos)
    speed = math.hypot(*over_ground)
    values: dict[str, Any] = dict.fromkeys(FIELDS, 0.0) | {
        "sender": sender,
        "yaw": wrapped(heading),
        "latitude": float(latitude[0]),
        "longitude": float(longitude[0]),
        "position_flags": int(valid),
        "acceleration_z": -1.0,
        "gyro_z": yaw_rate,
        "magnetic_x": cos,
        "magnetic_y": -sin,
        "orientation_11": cos,
        "orientation_12": sin,
        "orientation_21": -sin,
        "orientation_22": cos,
        "orientation_33": 1.0,
        "velocity_north": over_ground[0],
        "velocity_east": over_ground[1],
        "speed": speed,
        "ground_speed": speed,
        "course_over_ground": math.degrees(math.atan2(over_ground[1], over_ground[0])) % 360.0,
        "velocity_flags": int(valid),
        "utc": utc,
        "utc_flags": int(valid),
    }
    words = (
        str(value) if name in WHOLE else f"{value:.{DECIMALS.get(name, 6)}f}"
        for name, value in values.items()
    )
    return " ".join(words) + END


def words_of(packet: bytes) -> list[str]:
    """The words of a telemetry packet; ValueError where it is not ASCII."""
    return packet.replace(b"\0", b"").decode("ascii").split()


def read_sensor_line(words: Sequence[str], origin: Place) -> tuple[int, Array]:
    """Stamp [µs] and motion (6,) as `sensor_line` takes them; ValueError for any other line.

    A line whose GPS is not valid is refused too, and one with a speed that no boat has.
    """
    if len(words) != len(FIELDS):
        raise ValueError("not 40 fields")
    values = dict(zip(FIELDS, (np.array([float(word)]) for word in words), strict=True))
    if not all(np.isfinite(value[0]) for value in values.values()):
        raise ValueError("not finite")
    if not (int(words[FIELDS.index("position_flags")]) & int(words[FIELDS.index("velocity_flags")]) & VALID):
        raise ValueError("no fix")
    if not abs(values["latitude"][0]) <= 90.0 or not abs(values["longitude"][0]) <= 180.0:
        raise ValueError("no place")
    north, east = to_local(values["latitude"], values["longitude"], origin)
    moved = velocity(values)
    if not max(abs(moved["surge"][0]), abs(moved["sway"][0])) <= FASTEST:
        raise ValueError("no speed of a boat")
    if not abs(moved["yaw_rate"][0]) <= QUICKEST:
        raise ValueError("no yaw rate of a boat")
    motion = [north, east, values["yaw"], moved["surge"], moved["sway"], moved["yaw_rate"]]
    return int(words[FIELDS.index("utc")]), np.array(motion)[:, 0]
