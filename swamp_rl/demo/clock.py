"""Runs that began at different times, brought to the instants of one clock."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.demo.scene import DemoScene, Shown

Array = NDArray[np.float64]
MOST = 20_000
"""Instants of a clock; of longer runs it shows fewer in a second."""


def instants(scene: DemoScene) -> Array:
    """(N,) s from 0 to the end of the last run, as far apart as the densest run's rows."""
    finest = min(float(np.median(np.diff(item.run.time))) for item in scene.shown)
    step = max(finest, scene.end / MOST)
    # To the microsecond, so that equal instants of two recordings are equal.
    return np.round(np.arange(np.ceil(scene.end / step - 1e-6) + 1.0) * step, 6)


def poses_at(item: Shown, times: Array) -> Array:
    """(N, 3) north, east [m], heading [rad, not wrapped], between rows in proportion.

    A boat waits in its first pose until its run begins, and rests in its last.
    """
    own, pose = item.start + item.run.time - item.run.time[0], item.run.pose
    pose[:, 2] = np.unwrap(pose[:, 2])
    return np.stack([np.interp(times, own, column) for column in pose.T], axis=-1)


def values_at(item: Shown, values: Array, times: Array) -> Array:
    """(N, ...) the row of `values` (T, ...) that holds at each instant; NaN before the run and after it."""
    own = item.start + item.run.time - item.run.time[0]
    row = np.searchsorted(own, times + 1e-6, side="right") - 1
    outside = (row < 0) | (times > own[-1] + 0.5 * (own[-1] - own[-2]))
    found = np.array(values[np.maximum(row, 0)], dtype=float)
    found[outside] = np.nan
    return found
