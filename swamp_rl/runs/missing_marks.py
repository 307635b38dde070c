"""Marks that loggers write for a missing value: -999, 9999 and their like."""

import re
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


def without_marks(file: str, table: Table) -> Table:
    """The table of a file with NaN in place of every mark, and a fault for each stretch of rows that has one.

    A mark is a number of three to seven nines, of either sign, to which a column jumps, from either side,
    JUMP times as far as it moves elsewhere: a position of just -999 m on a track is none. Nor is a step of a
    command, which lasts: a column that changes elsewhere no more often than it jumps has marks in less than
    BRIEF of its rows.
    """
    columns, unread, faults = dict(table.columns), dict(table.unread), list(table.faults)
    for name, values in table.columns.items():
        for mark in _nines(values):
            wrong = values == mark
            if not _is_jumped_to(values, wrong):
                continue
            columns[name] = np.where(wrong, np.nan, columns[name])
            unread[name] = unread.get(name, np.zeros(len(values), bool)) | wrong
            told = f"is missing, marked by {mark:.0f}; fill it in or remove the row"
            faults += faults_at(file, name, table.rows, wrong, partial(_said, told))
    return replace(table, columns=columns, unread=unread, faults=faults)


def _said(told: str, row: int) -> str:
    return told


def _nines(values: NDArray[np.float64]) -> list[float]:
    """The numbers of nines alone among values."""
    whole = np.unique(values[np.isfinite(values) & (values == np.round(values))])
    return [float(number) for number in whole if NINES.fullmatch(f"{number:.0f}")]


def _is_jumped_to(values: NDArray[np.float64], wrong: NDArray[np.bool_]) -> bool:
    steps = np.abs(np.diff(values))
    known = np.isfinite(steps)
    inside = known & ~wrong[1:] & ~wrong[:-1]
    across = known & (wrong[1:] != wrong[:-1])
    if not (inside.any() and across.any()):
        return False
    rare = np.count_nonzero(across) < np.count_nonzero(steps[inside]) or wrong.mean() < BRIEF
    return bool(rare and steps[across].min() > JUMP * steps[inside].max())
