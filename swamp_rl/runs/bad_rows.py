"""What becomes of the rows of a foreign table that are wrong: refused, cut out, or a border between runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.runs.check import STEP_TOLERANCE
from swamp_rl.runs.faults import Fault, condensed, faults_at

Array = NDArray[np.float64]
BadRows = Literal["refuse", "cut", "split"]

MOST_TOLD = 20
"""Faults that are listed, then a count."""
REFUSED = "nothing was imported"
FEWEST_ROWS = 10
"""Of a stretch that is kept: as many as `runs check` needs to compare heading with yaw rate."""
MOST_BAD = 0.5
"""Share of the rows outside of pauses that hold a number: where more are bad, it is not the rows that are
wrong."""
GAP_STEPS = 3.0
"""Median steps: a longer one between uneven rows is a gap."""


@dataclass(frozen=True)
class Stretches:
    """Index arrays into the table's rows, one for each run that is kept, and lines that tell what is not."""

    kept: list[NDArray[np.int64]]
    cut: list[str]


def first_of(lines: Sequence[str]) -> list[str]:
    """MOST_TOLD lines, and the count of the others."""
    others = len(lines) - MOST_TOLD
    return [*lines[:MOST_TOLD], *([f"and {counted(others, 'more fault')}"] if others > 0 else [])]


def listed(lines: Sequence[str], ending: str) -> str:
    """The first of the lines, and how it ends."""
    first = first_of(lines)
    return "\n".join([*first[:-1], f"{first[-1]}; {ending}"])


def gaps(steps: Array, fill: float) -> NDArray[np.bool_]:
    """Which steps (T − 1,) [s] of uneven rows are longer than `fill` [s] and GAP_STEPS median ones."""
    forward = steps[steps > 0.0]
    period = float(np.median(forward)) if len(forward) else 0.0
    return np.asarray(steps > max(fill, GAP_STEPS * period))


def gap_faults(file: str, time: Array, rows: NDArray[np.int64], fill: float) -> list[Fault]:
    """The faults of gaps between rows at increasing times (T,) [s] that are to be resampled."""
    steps = np.diff(time)

    def message(i: int) -> str:
        return f"{steps[i]:.6g} s after the row before; --fill SECONDS interpolates, --bad-rows cuts"

    return faults_at(file, "time", rows[1:], gaps(steps, fill), message)


def stretches(
    file: str,
    columns: Mapping[str, Array],
    rows: NDArray[np.int64],
    faults: Sequence[Fault],
    policy: BadRows,
    even: bool,
    fill: float,
) -> Stretches:
    """The runs that remain of a table without its bad rows.

    faults: those that name rows. A row whose time is that of the row before is bad, too; a time that goes
    back ends a stretch. even: whether the rows of a run must come at one rate (no resampling follows); then a
    step of another length ends a stretch, else one of the `gaps`.
    `cut` keeps the longest stretch, `split` all of FEWEST_ROWS or more. UserError where none remains.
    """
    time = columns["time"]
    values = [values for name, values in columns.items() if name != "time"]
    paused = _of_faults(rows, [fault for fault in faults if fault.pause]) | np.isnan(values).all(axis=0)
    bad = _of_faults(rows, faults)
    good = np.flatnonzero(~bad & np.isfinite(time))
    again = good[1:][np.diff(time[good]) == 0.0]
    good = np.setdiff1d(good, again)
    bad[again] = True
    repeated = [Fault(file, int(rows[i]), "time", "is that of the row before") for i in again]
    lines = [str(fault) for fault in condensed([*faults, *repeated])]
    steps = np.diff(time[good])
    if even:
        forward = steps[steps > 0.0]
        period = float(np.median(forward)) if len(forward) else 1.0
        border = np.abs(steps - period) > STEP_TOLERANCE * period
    else:
        border = (steps < 0.0) | gaps(steps, fill)
    told = np.flatnonzero(border & (np.diff(np.cumsum(bad)[good]) == 0))  # steps without a bad row between
    if len(told):
        first, last = (int(rows[good[i + 1]]) for i in told[[0, -1]])
        message = f"{steps[told[0]]:.6g} s after the row before"
        lines.append(str(Fault(file, first, "time", message, last, len(told) - 1)))
    parts = np.split(good, np.flatnonzero(border) + 1)
    kept = [part for part in parts if len(part) >= FEWEST_ROWS]
    share = float(np.mean(bad[~paused])) if not paused.all() else 0.0
    if not kept or share > MOST_BAD:
        raise UserError(_hopeless(file, lines, even, share))
    if policy == "cut":
        kept = [max(kept, key=len)]
    return Stretches(kept, _summary(rows, kept, lines))


def _of_faults(rows: NDArray[np.int64], faults: Sequence[Fault]) -> NDArray[np.bool_]:
    """Which rows have one of the faults."""
    found = np.zeros(len(rows), bool)
    for fault in faults:
        if fault.row is not None:
            found |= (rows >= fault.row) & (rows <= (fault.last or fault.row))
    return found


def _hopeless(file: str, lines: Sequence[str], even: bool, share: float) -> str:
    """What is wrong with a file of which nothing can be kept."""
    if share > MOST_BAD:
        ending = f"{share:.0%} of the rows are bad, so a unit or the mapping is wrong; {REFUSED}"
        return listed(lines, ending)
    hint = ", or --resample HZ where the rows come at uneven times" if even else ""
    return f"{file}: no {FEWEST_ROWS} rows without a fault follow one another{hint}; {REFUSED}"


def _summary(rows: NDArray[np.int64], kept: list[NDArray[np.int64]], lines: list[str]) -> list[str]:
    count = sum(map(len, kept))
    if count == len(rows) and len(kept) == 1:
        return []
    spans = ", ".join(f"{rows[part[0]]} to {rows[part[-1]]}" for part in kept[:MOST_TOLD])
    more = f" and {len(kept) - MOST_TOLD} more" if len(kept) > MOST_TOLD else ""
    return [
        f"{len(rows) - count} of {counted(len(rows), 'row')} left out; kept are rows {spans}{more}",
        *first_of(lines),
    ]
