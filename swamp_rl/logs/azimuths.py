"""Azimuths of a log, which are often given within one turn, as a boat's thrusters obey them."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, Thruster
from swamp_rl.runs.check import command_counts_turns
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.schema import RunMeta

Array = NDArray[np.float64]

TURN = 2.0 * math.pi
ROUNDING = 0.02  # rad, by which a log's angles of one turn may pass it


def with_nearest_azimuths(found: Foreign, boat: Boat) -> Foreign:
    """The table with each azimuth as the boat's thruster counts it.

    A thruster without limits turns the shorter way, so that a log within one turn is unwrapped; a log that
    passes one turn counts already. An angle outside a thruster's limits is the equivalent one within them.
    A column that jumps beyond a turn is not in radians and stays as it is.
    """
    columns, notes = dict(found.table.columns), []
    for thruster in boat.thrusters:
        name = thruster.command_columns[0]
        if not isinstance(thruster, Thruster) or name is None or name not in columns:
            continue
        values = columns[name]
        if not command_counts_turns(values, None):
            continue
        if math.isinf(thruster.azimuth_max):
            columns[name] = _unwrapped(values)
        else:
            columns[name] = _within(values, thruster.azimuth_min, thruster.azimuth_max)
        turns = np.round((columns[name] - values)[np.isfinite(values)] / TURN)
        changed = int(np.count_nonzero(np.diff(turns, prepend=0.0)))
        notes += [f"{name} is taken by the nearest equivalent angle {changed} times"] if changed else []
    if not notes:
        return found
    meta = RunMeta.model_validate(found.meta.model_dump() | {"azimuths": "; ".join(notes)})
    return replace(found, table=replace(found.table, columns=columns), meta=meta)


def _unwrapped(values: Array) -> Array:
    """Angles (T,) [rad] that change by half a turn at most from row to row, where they are of one turn."""
    known = np.isfinite(values)
    if not known.any() or np.ptp(values[known]) > TURN + ROUNDING:
        return values
    made = values.copy()
    made[known] = np.unwrap(values[known])
    return made


def _within(values: Array, low: float, high: float) -> Array:
    """Angles (T,) [rad], those outside the limits by the equivalent angle within them, where there is one."""
    with np.errstate(invalid="ignore"):
        outside = (values < low - ROUNDING) | (values > high + ROUNDING)
        equal = low + np.mod(values - low, TURN)
        return np.asarray(np.where(outside & (equal <= high + ROUNDING), equal, values))
