"""A run that is right in every column, and the `dataset.yaml` of such runs."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.runs import DatasetMeta

THRUSTERS = ("bs", "bp", "ss", "sp")
SAMPLE_RATE = 10.0


def circling(seconds: float = 3.0, start: float = 0.0) -> dict[str, NDArray[np.float64]]:
    """Columns of a boat on a circle of 2 m at 0.5 m/s, with every thruster commanded."""
    time = np.arange(round(seconds * SAMPLE_RATE) + 1) / SAMPLE_RATE
    course = start + 0.25 * time
    columns = {
        "time": time,
        "north": 2.0 * np.sin(course),
        "east": -2.0 * np.cos(course),
        "heading": np.pi - np.mod(np.pi - course, 2.0 * np.pi),
        "surge": np.full_like(time, 0.5),
        "sway": np.zeros_like(time),
        "yaw_rate": np.full_like(time, 0.25),
    }
    columns |= {f"azimuth_{name}": 0.3 * np.sin(time) for name in THRUSTERS}
    columns |= {f"throttle_{name}": 0.5 + 0.1 * np.cos(time) for name in THRUSTERS}
    return columns | {"joy_thrust": 0.5 + 0.1 * np.cos(time), "joy_angle": 0.2 * np.sin(time)}


def described(**changes: object) -> DatasetMeta:
    """A `dataset.yaml` for the runs of `circling`."""
    values = {
        "vehicle": "swamp",
        "mass": 58.0,
        "draught": 0.14,
        "water_density": 1025.0,
        "sample_rate": SAMPLE_RATE,
        "source": "simulated",
        "course": "camogli",
    }
    return DatasetMeta.model_validate(values | changes)
