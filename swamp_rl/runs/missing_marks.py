"""Marks that loggers write for a missing value: -999, 9999 and their like."""

import re
from collections.abc import Collection
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from swamp_rl.runs.faults import faults_at
from swamp_rl.runs.table import Table

NINES = re.compile(r"-?9{3,7}")
JUMP = 10.0
"""Times the longest step between other values that a column jumps to a mark and back."""
BRIEF = 0.05
"""Share of the rows."""
TURN = 360.0
"""Degrees: of angles that are all within one, in radians too, a number of nines is none."""


def without_marks(file: str, table: Table, angles: Collection[str] = ()) -> Table:
    """The table of a file with NaN in place of every mark, and a fault for each stretch of rows that has one.

    angles: columns of angles, in degrees or radians. A mark is a number of three to seven nines, of either
    sign, to which a column jumps, from either side, JUMP times as far as it moves elsewhere: a position of
    just -999 m on a track is none. A compass, which jumps at north, has marks beyond the TURN that it is
    within elsewhere. A step of a command, which lasts, is no mark: a column that changes elsewhere no more
    often than it jumps has marks in less than BRIEF of its rows.
    """
    columns, unread, faults = dict(table.columns), dict(table.unread), list(table.faults)
    for name, values in table.columns.items():
        nines = _nines(values)
        others = np.abs(values[np.isfinite(values) & ~np.isin(values, nines)]) if nines else values
        turning = name in angles and len(others) > 0 and float(others.max()) <= TURN
        for mark in nines:
            wrong = values == mark
            if not (_is_rare(values, wrong) and (turning or _is_jumped_to(values, wrong))):
                continue
            columns[name] = np.where(wrong, np.nan, columns[name])
            unread[name] = unread.get(name, np.zeros(len(values), bool)) | wrong
            message = f"is missing, marked by {mark:.0f}; fill it in or remove the row"
            faults += faults_at(file, name, table.rows, wrong, partial(_message, message))
    return replace(table, columns=columns, unread=unread, faults=faults)


def _message(message: str, row: int) -> str:
    return message


def _nines(values: NDArray[np.float64]) -> list[float]:
    """The numbers of nines alone among values."""
    whole = np.unique(values[np.isfinite(values) & (values == np.round(values))])
    return [float(number) for number in whole if NINES.fullmatch(f"{number:.0f}")]


def _is_rare(values: NDArray[np.float64], wrong: NDArray[np.bool_]) -> bool:
    """Whether a column changes elsewhere more often than it jumps to a mark, or the mark is brief."""
    steps, inside, across = _steps(values, wrong)
    rare = np.count_nonzero(across) < np.count_nonzero(steps[inside]) or wrong.mean() < BRIEF
    return bool(inside.any() and across.any() and rare)


def _is_jumped_to(values: NDArray[np.float64], wrong: NDArray[np.bool_]) -> bool:
    steps, inside, across = _steps(values, wrong)
    return bool(steps[across].min() > JUMP * steps[inside].max())


def _steps(
    values: NDArray[np.float64], wrong: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Steps (T − 1,) from row to row, which of them are between other values, and which to or from a mark."""
    steps = np.abs(np.diff(values))
    known = np.isfinite(steps)
    return steps, known & ~wrong[1:] & ~wrong[:-1], known & (wrong[1:] != wrong[:-1])
