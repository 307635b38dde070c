"""What is wrong with a recorded run, and where."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NO_NUMBER = "holds no number in any row; record it, or leave the column out where it is optional"


@dataclass(frozen=True, order=True)
class Fault:
    """One fault: `row` counts the data rows from 1 (a CSV's header is line 1, so its row 1 is line 2); `last`
    is the last row of the same fault, where it holds for consecutive rows."""

    file: str
    row: int | None
    column: str | None
    message: str
    last: int | None = None

    def __str__(self) -> str:
        line = (
            f" (line {self.row + 1})" if self.row is not None and self.file.lower().endswith(".csv") else ""
        )
        row = [] if self.row is None else [f"row {self.row}{line}"]
        column = [] if self.column is None else [f"column {self.column}"]
        return ": ".join([self.file, *filter(None, [", ".join(row + column)]), self.message])


def faults_at(
    file: str, column: str, rows: NDArray[np.int64], wrong: NDArray[np.bool_], describe: Callable[[int], str]
) -> list[Fault]:
    """One fault for each stretch of consecutive wrong rows, worded by `describe` from its first index."""
    indices = np.flatnonzero(wrong)
    stretches = np.split(indices, np.flatnonzero(np.diff(indices) > 1) + 1) if len(indices) else []
    found = []
    for stretch in stretches:
        first, last = stretch[0], stretch[-1]
        until = f" (and so on to row {rows[last]})" if last > first else ""
        told = describe(int(first)) + until
        found.append(Fault(file, int(rows[first]), column, told, int(rows[last])))
    return found
