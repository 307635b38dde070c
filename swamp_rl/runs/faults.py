"""What is wrong with a recorded run, and where."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.clipped import printable

NUMBER = re.compile(r"-?\d[\d.]*(?:e[-+]?\d+)?")
NO_NUMBER = "holds no number in any row; record it, or leave the column out where it is optional"


@dataclass(frozen=True, order=True)
class Fault:
    """One fault: `row` counts the data rows from 1 (a CSV's header is line 1, so its row 1 is line 2); `last`
    is the last row of the same fault, where it holds for consecutive rows, or for `alike` more that are not;
    `pause`: its rows are of the even grid alone, in a pause of the messages.
    """

    file: str
    row: int | None
    column: str | None
    message: str
    last: int | None = None
    alike: int = 0
    pause: bool = False

    def __str__(self) -> str:
        in_text = self.file.lower().endswith(".csv") and not self.pause
        line = f" (line {self.row + 1})" if self.row is not None and in_text else ""
        row = [] if self.row is None else [f"row {self.row}{line}"]
        column = [] if self.column is None else [f"column {self.column}"]
        message = self.message
        if self.alike:
            message += f" (in {self.alike + 1} of rows {self.row} to {self.last})"
        elif self.row is not None and self.last is not None and self.last > self.row:
            message += f" (in each of rows {self.row} to {self.last}: {self.last - self.row + 1} rows)"
        return printable(": ".join([self.file, *filter(None, [", ".join(row + column)]), message]))


def condensed(faults: Sequence[Fault]) -> list[Fault]:
    """One fault for all rows of a column whose messages differ by numbers only, in the first one's place."""
    found: dict[tuple[object, ...], Fault] = {}
    for fault in faults:
        key = (fault.file, fault.column, fault.row is None, NUMBER.sub("#", fault.message))
        if fault.row is None or key not in found:
            found[key if fault.row is not None else (*key, fault.message)] = fault
            continue
        first, rows = found[key], (fault.last or fault.row) - fault.row + 1
        before = first.alike or (first.last or first.row or 0) - (first.row or 0)
        found[key] = replace(first, last=fault.last or fault.row, alike=before + rows)
    return list(found.values())


def faults_at(
    file: str, column: str, rows: NDArray[np.int64], wrong: NDArray[np.bool_], describe: Callable[[int], str]
) -> list[Fault]:
    """One fault for each stretch of consecutive wrong rows, worded by `describe` from its first index."""
    indices = np.flatnonzero(wrong)
    stretches = np.split(indices, np.flatnonzero(np.diff(indices) > 1) + 1) if len(indices) else []
    found = []
    for stretch in stretches:
        first, last = stretch[0], stretch[-1]
        found.append(Fault(file, int(rows[first]), column, describe(int(first)), int(rows[last])))
    return found
