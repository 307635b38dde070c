"""Mapped angles beyond a turn: those that an expression takes there, and those that are wrong."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.errors import UserError
from swamp_rl.logs.expression import Name
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapped_column import Column, added_by
from swamp_rl.logs.mapping import Mapping
from swamp_rl.runs.check import FASTEST_TURN, counts_turns
from swamp_rl.runs.stamps import Stamps

Array = NDArray[np.float64]

TURN = 2.0 * math.pi + 1e-3  # rad, with the rounding of a log


def refuse_beyond_turn(
    log: Log, mapping: Mapping, name: str, column: Column | None, stamps: Stamps, angle: Array
) -> None:
    """UserError for a mapped angle (T,) [rad] with rows that `_beyond_turn` has.

    column: what it is made of, None for the yaw of a quaternion; stamps: of its rows.
    """
    time, spare = stamps.time, _spare(log, mapping, name, column, stamps)
    wrong, counts = _beyond_turn(time, angle, spare)
    if not wrong.any():
        return
    largest = int(np.argmax(np.where(wrong, np.abs(angle), 0.0)))
    unit = mapping.units.get(name)
    if unit == "deg" or counts:
        value = f"{np.degrees(angle[largest]):.4g} deg" if unit == "deg" else f"{angle[largest]:.4g} rad"
        raise UserError(
            f"{log.file}: --map {name}: row {largest + 1}: {value} is more than a turn; correct it or "
            "leave the row out"
        )
    raise UserError(
        f"{log.file}: --map {name}: reaches {abs(angle[largest]):.4g} rad, as angles in degrees do; give it "
        f"in radians (--degrees {name})"
    )


def wrapped_where_known(
    log: Log, mapping: Mapping, name: str, column: Column, stamps: Stamps, angle: Array
) -> Array:
    """A mapped angle (T,) [rad] in (−π, π] if it is computed or has a unit, but for rows that `_beyond_turn`
    has; else as it is."""
    if isinstance(column.node, Name) and name not in mapping.units:
        return angle
    wrong, _ = _beyond_turn(stamps.time, angle, _spare(log, mapping, name, column, stamps))
    right = np.isfinite(angle) & ~wrong
    found = angle.copy()
    found[right] = wrapped(angle[right])
    return found


def _spare(log: Log, mapping: Mapping, name: str, column: Column | None, stamps: Stamps) -> Array | float:
    """What an expression may add (T,) [rad] to an angle within a turn: at most another one."""
    return 0.0 if column is None else np.minimum(added_by(log, mapping, name, column, stamps), TURN)


def _beyond_turn(time: Array, angle: Array, spare: Array | float) -> tuple[NDArray[np.bool_], bool]:
    """Which rows of an angle (T,) [rad] at times (T,) [s] are beyond a turn and `spare` (T,) [rad]; and
    whether the angle counts its turns: then only rows apart from both neighbours are so."""
    known = np.flatnonzero(np.isfinite(angle) & np.isfinite(time))
    beyond = np.zeros(len(angle), bool)
    beyond[known] = (np.abs(angle) > TURN + spare)[known]
    time, angle = time[known], angle[known]
    later = np.diff(time, prepend=-math.inf) > 0.0
    counts = counts_turns(angle[later], time[later])
    if counts:
        beyond[known] &= _apart(angle, time)
    return beyond, counts


def _apart(angle: Array, time: Array) -> NDArray[np.bool_]:
    """(T,) whether a row is over a quarter of a turn from both neighbours, and faster than a boat turns."""
    jumps = np.abs(np.diff(angle)) > np.maximum(0.5 * math.pi, FASTEST_TURN * np.abs(np.diff(time)))
    return np.append(jumps, True) & np.insert(jumps, 0, True)
