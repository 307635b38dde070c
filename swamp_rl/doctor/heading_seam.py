"""Headings that were interpolated as numbers from one end of their range to the other, as from 359 to 1
degree through 180, in place of along the shorter arc.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import FULL_TURN, wrapped
from swamp_rl.counted import counted
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.runs.bad_rows import FEWEST_ROWS

Array = NDArray[np.float64]

USUAL, FAST = 0.95, 4.0
"""Quantile of the turning rates, and how many times that between two samples the heading turns."""
SEAMS = 0.0, np.pi
"""rad: north, of compasses from 0 to 360 degrees, and south, of those from -180 to 180."""
NEAR, AT = 0.5, 1e-6
"""rad from the seam: of the heading before and after at most, and of a heading at the seam."""
EVEN = 0.05
"""Spread of the steps between two samples, relative to their median: those of an interpolation are equal."""
CLEAR, WITHIN = 1.2, 0.8
"""Times the fastest other turn, and at most times the slowest interpolation across the seam (another row may
be off): the rate from which the advice leaves rows out."""


def seam_findings(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """A finding with the runs whose heading was interpolated across its seam; and the runs, divided there
    into parts of FEWEST_ROWS or more."""
    names, places, divided, fastest, slowest = [], [], [], 0.0, np.inf
    for run in runs:
        stretches = _stretches(run)
        if not stretches:
            divided.append(run)
            continue
        names.append(run.name)
        places += [f"{run.time[a]:.1f} to {run.time[b]:.1f} s of {run.name}" for a, b in stretches]
        edges = [0, *(row for a, b in stretches for row in (a, b + 1)), len(run.time)]
        kept = [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= FEWEST_ROWS]
        fastest = max([fastest, *(_rates(run, part).max() for part in kept)])
        slowest = min([slowest, *(float(np.median(_rates(run, slice(a, b + 1)))) for a, b in stretches)])
        divided += [Run(run.name, {n: v[part] for n, v in run.columns.items()}, run.meta) for part in kept]
    if not names:
        return [], divided
    message = (
        "is interpolated across its seam, as from 359 to 1 degree through 180, at "
        f"{counted(len(places), 'place')}, first from {places[0]}"
    )
    limit = min(CLEAR * fastest, WITHIN * slowest)
    missing = f"heading=where(abs(turn_rate(heading)) > {limit:.3g}, 0/0, heading)"
    advice = (
        "interpolate its sine and cosine; or leave these rows out: swamp-rl runs import, of this dataset, "
        f"--map '{missing}' --bad-rows split, where --resample HZ --fill SECONDS keeps the runs whole"
    )
    figures = {"places": float(len(places))}
    return [Finding("fault", "heading_seam", ("heading",), message, advice, tuple(names), figures)], divided


def _stretches(run: Run) -> list[tuple[int, int]]:
    """First and last row of each interpolation across the seam at north or south."""
    heading, yaw_rate = run.columns.get("heading"), run.columns.get("yaw_rate")
    steps = np.diff(run.time)
    if heading is None or len(steps) < 3 or not np.isfinite(heading).all() or not (steps > 0.0).all():
        return []
    fast = _fast(np.asarray(wrapped(np.diff(heading))) / steps, FAST)
    # A boat that truly turns there has a fast yaw rate, in whichever unit.
    turns_there = np.zeros(len(heading), bool) if yaw_rate is None else _fast(yaw_rate, 0.5 * FAST)
    found = []
    for seam in SEAMS:
        above = (heading - seam) % FULL_TURN
        away = np.minimum(above, FULL_TURN - above)
        at = away < AT  # 0 and 360 degrees are one heading
        turns = np.where(at[1:] | at[:-1], wrapped(np.diff(above)), np.diff(above))
        ways = np.where(fast, np.sign(turns), 0.0)
        edges = np.flatnonzero(np.diff(ways, prepend=0.0, append=0.0) != 0.0)
        found += [
            (a, b)
            for a, b in pairwise(edges.tolist())
            if ways[a] != 0.0
            and max(away[a], away[b]) < NEAR
            and _is_excursion(turns[a:b])
            and turns_there[a + 1 : b].mean() < 0.5
        ]
    return sorted(found)


def _fast(rates: Array, factor: float) -> NDArray[np.bool_]:
    """Where rates (N,) are more than so many times their USUAL quantile; nowhere by rates that are NaN."""
    sizes = np.abs(rates)
    return sizes > factor * float(np.quantile(sizes, USUAL))


def _is_excursion(turns: Array) -> bool:
    """Whether turns (N,) [rad] to one side go the long way from one side of the seam to the other."""
    inner = turns[1:-1]
    even = len(inner) < 2 or float(np.ptp(inner)) <= EVEN * abs(float(np.median(inner)))
    return len(turns) > 1 and even and abs(float(turns.sum())) > FULL_TURN - 2.0 * NEAR


def _rates(run: Run, part: slice) -> Array:
    """Turning rates [rad/s] within a part of a run, as `turn_rate` has them."""
    return np.abs(np.gradient(np.unwrap(run.columns["heading"][part]), run.time[part]))
