"""Figures of a followed path and of a held station."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.guidance.curve import Curve, progress
from swamp_rl.guidance.following import LOOKAHEAD
from swamp_rl.simulator.state import EAST, HEADING, NORTH

Array = NDArray[np.float64]


def spread(values: Array) -> dict[str, float]:
    """Mean, root mean square, 95 % quantile and greatest of magnitudes |e|, in their unit."""
    size = np.abs(values)
    return {
        "mean": float(size.mean()),
        "rms": math.sqrt(float((size * size).mean())),
        "quantile_95": float(np.quantile(size, 0.95)),
        "max": float(size.max()),
    }


def along_and_across(curve: Curve, track: Array, length: float) -> Array:
    """(T, 2) arc length and cross-track error [m], positive to starboard, of states (T, S) of a boat of that
    length [m]."""
    return progress(curve, track[:, [NORTH, EAST]], LOOKAHEAD * length / SWAMP_LENGTH)


def station_errors(track: Array, place: tuple[float, float], heading: float) -> tuple[Array, Array]:
    """(T,) distance [m] from a place, and (T,) heading error [rad] of states (T, S)."""
    away = np.hypot(track[:, NORTH] - place[0], track[:, EAST] - place[1])
    turned = wrapped(track[:, HEADING] - heading)
    return away, turned
