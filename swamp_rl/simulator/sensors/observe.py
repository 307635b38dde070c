"""From the boat's motion to what is measured of it, and back at a start."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.simulator.state import HEADING, NORTH, SURGE, SWAY, YAW_RATE

Array = NDArray[np.float64]

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")


def observe(track: Array, params: NDArray[Any], dt: float) -> Array:
    """Measured channels (n, T, 6), in the order of `CHANNELS`, of tracks (n, T, S) in rows of dt [s].

    params: (n,) parameter records, read for the sensors' effects. Positions are the antenna's, at the time
    before now that `position_delay` says, linear between rows and continued straight before the first one.
    The heading is not wrapped; velocities over ground are midship's.
    """
    measured = track[:, :, NORTH : YAW_RATE + 1].copy()
    at_midship = (params["antenna_x"] == 0.0) & (params["antenna_y"] == 0.0)
    if not at_midship.all():
        measured[:, :, :2] += antenna_offset(track[:, :, HEADING], params, (slice(None), None))
    for i in np.flatnonzero(params["position_delay"] > 0.0):
        measured[i, :, :2] = positions_before(
            measured[i, :, :2], track[i, 0], params["position_delay"][i] / dt, dt
        )
    measured[:, :, HEADING] += params["heading_bias"][:, None]
    return measured


def antenna_offset(heading: Array, params: NDArray[Any], place: Any = ...) -> Array:
    """North and east [m] from midship to the antenna at each heading [rad]; params[place] fits its shape."""
    x, y = params["antenna_x"][place], params["antenna_y"][place]
    cos, sin = np.cos(heading), np.sin(heading)
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)


def positions_before(position: Array, start: Array, rows: float, dt: float) -> Array:
    """Positions (T, 2) as they were `rows` before each; start (S,): the first state, with its velocity."""
    cos, sin = np.cos(start[HEADING]), np.sin(start[HEADING])
    north = start[SURGE] * cos - start[SWAY] * sin
    east = start[SURGE] * sin + start[SWAY] * cos
    row = np.arange(len(position)) - rows
    before = np.minimum(row, 0.0) * dt
    late = [np.interp(row, np.arange(len(position)), column) for column in position.T]
    return np.stack(late, axis=1) + before[:, None] * np.array([north, east])


def true_pose(pose: Array, velocity: Array, params: NDArray[Any]) -> Array:
    """Poses (n, 3) of midship from measured ones (n, 3) and velocities (n, 3): surge, sway, yaw rate.

    The inverse of the first row of `observe`.
    """
    true = pose.copy()
    true[:, 2] -= params["heading_bias"]
    true[:, :2] -= antenna_offset(true[:, 2], params)
    cos, sin = np.cos(true[:, 2]), np.sin(true[:, 2])
    over_ground = np.stack(
        [velocity[:, 0] * cos - velocity[:, 1] * sin, velocity[:, 0] * sin + velocity[:, 1] * cos], axis=1
    )
    true[:, :2] += over_ground * params["position_delay"][:, None]
    return true


def add_noise(measured: Array, deviations: Array, rng: np.random.Generator) -> Array:
    """`measured` (..., C) with independent normal noise of those standard deviations (C,)."""
    return measured + deviations * rng.standard_normal(measured.shape)
