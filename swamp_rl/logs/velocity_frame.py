"""Whether a ROS message gives the velocity in axes of the boat or of the earth, by the positions.

A TwistStamped may be either; some simulators write an Odometry's twist in axes of the earth against its
definition.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.logs.expression import Node
from swamp_rl.logs.mapping import Mapping
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.local_frame import to_local
from swamp_rl.runs.table import Table

Array = NDArray[np.float64]

SPAN = 5.0
"""s over which displacement and integrated velocity are compared."""
CLEARER = 0.5
"""Ratio of their differences, below which the axes are those of the earth."""


def foreign_in_its_axes(mapping: Mapping, convert: Callable[[Mapping], Foreign]) -> Foreign:
    """The run of a mapping with `u` and `v`, these in axes of the earth where the positions say so."""
    of_body = convert(mapping)
    there = set(of_body.table.columns)
    if "heading" not in there or not {"north", "latitude"} & there:
        return of_body
    of_earth = convert(_of_earth(mapping))
    errors = [displacement_error(one.table) for one in (of_body, of_earth)]
    if not errors[1] < CLEARER * errors[0]:
        return of_body
    metadata = {
        "velocity": f"in axes of the earth: differs from the displacement by {errors[1]:.2g} m in {SPAN:g} s"
    }
    metadata["velocity"] += f", in axes of the boat by {errors[0]:.2g} m"
    return replace(of_earth, meta=of_earth.meta.model_copy(update=metadata))


def _of_earth(mapping: Mapping) -> Mapping:
    """The mapping with the velocity over ground in place of u and v."""
    names = {"u": "vx", "v": "vy"}
    columns: dict[str, Node] = {names.get(name, name): node for name, node in mapping.columns.items()}
    units = {names.get(name, name): unit for name, unit in mapping.units.items()}
    frames = {names.get(name, name): frame for name, frame in mapping.frames.items()}
    return replace(mapping, columns=columns, units=units, frames=frames)


def displacement_error(table: Table) -> float:
    """Root mean square distance [m] between displacement in SPAN and the integral of surge and sway; NaN for
    a run too short."""
    columns = table.columns
    time, heading = columns["time"], columns["heading"]
    rows = max(1, round(SPAN / float(np.median(np.diff(time)))))
    place = np.stack(_place(columns), axis=1)
    cos, sin, surge, sway = np.cos(heading), np.sin(heading), columns["surge"], columns["sway"]
    velocity = np.stack([surge * cos - sway * sin, surge * sin + sway * cos], axis=1)
    moved = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time)[:, None]
    known = np.isfinite(moved)
    total, count = (np.cumsum(np.where(known, moved, 0.0), axis=0), np.cumsum(known, axis=0))
    apart = place[rows + 1 :] - place[1:-rows] - (total[rows:] - total[:-rows])
    whole = (count[rows:] - count[:-rows] == rows).all(axis=1) & np.isfinite(apart).all(axis=1)
    return float(np.sqrt((apart[whole] ** 2).sum(axis=1).mean())) if whole.any() else float("nan")


def _place(columns: dict[str, Array]) -> tuple[Array, Array]:
    """North and east [m]."""
    if "north" in columns:
        return columns["north"], columns["east"]
    latitude, longitude = columns["latitude"], columns["longitude"]
    first = int(np.argmax(np.isfinite(latitude + longitude)))
    return to_local(latitude, longitude, (float(latitude[first]), float(longitude[first])))
