"""Positions that jump: a row far from both the one before and where the boat can have gone."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.runs.bad_rows import FEWEST_ROWS

Array = NDArray[np.float64]

USUAL = 0.95
"""Quantile of the speeds from row to row that the jumps are compared with."""
JUMP = 20.0
"""Times that speed: white noise has no step beyond four times its quantile."""


def jump_findings(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """A finding with the runs whose position goes from one row to the next JUMP times as fast as it does in
    USUAL of the steps; and the runs, divided there into parts of FEWEST_ROWS or more."""
    names, first, longest, fast, slowest = [], "", 0.0, 0.0, np.inf
    divided = []
    for run in runs:
        moved, speed, usual = _steps(run)
        wrong = speed > JUMP * usual
        fast = max(fast, usual)
        if usual == 0.0 or not wrong.any():
            divided.append(run)
            continue
        row = int(np.argmax(wrong))
        first = first or f"{moved[row]:.3g} m, at {run.time[row + 1]:.1f} s of {run.name}"
        longest, slowest = max(longest, float(moved[wrong].max())), min(slowest, float(speed[wrong].min()))
        names.append(run.name)
        edges = [0, *(np.flatnonzero(wrong) + 1).tolist(), len(run.time)]
        parts = [slice(begin, end) for begin, end in pairwise(edges) if end - begin >= FEWEST_ROWS]
        divided += [Run(run.name, {n: v[part] for n, v in run.columns.items()}, run.meta) for part in parts]
    if not names:
        return [], divided
    message = f"jumps from one row to the next, first by {first}"
    # `rate` spans two steps, of which one jumps.
    least = max(0.4 * slowest, 4.0 * fast)
    keep = f"keep=where(sqrt(rate(north)**2 + rate(east)**2) > {least:.3g}, 0, 1)"
    advice = f"divide the runs there: swamp-rl runs import, of this dataset, --map '{keep}'"
    columns, figures = ("north", "east"), {"longest_jump_m": longest}
    return [Finding("fault", "position_jump", columns, message, advice, tuple(names), figures)], divided


def _steps(run: Run) -> tuple[Array, Array, float]:
    """(T - 1,) distances [m] and speeds [m/s] from row to row, 0 where unknown, and the usual speed."""
    if not {"north", "east"} <= set(run.columns) or len(run.time) < 3:
        return np.zeros(0), np.zeros(0), 0.0
    moved = np.hypot(np.diff(run.columns["north"]), np.diff(run.columns["east"]))
    steps = np.diff(run.time)
    known = np.isfinite(moved) & (steps > 0.0)
    speed = np.where(known, moved, 0.0) / np.where(known, steps, 1.0)
    return moved, speed, float(np.quantile(speed[known], USUAL)) if known.any() else 0.0
