"""Headings that were interpolated as numbers from one end of their range to the other, as from 359 to 1
degree through 180, in place of along the shorter arc.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.runs.bad_rows import FEWEST_ROWS

Array = NDArray[np.float64]

USUAL, FAST = 0.95, 4.0
"""Quantile of the turning rates, and how many times that between two samples the heading turns."""
NEAR = 0.5
"""rad: the boat turns by less between two samples, and points so near to the seam before and after."""
FARTHEST = 1.0
"""rad: an excursion of the heading turns by more in all."""
EVEN = 0.05
"""Spread of the steps between two samples, relative to their median: those of an interpolation are equal."""
CLEAR = 1.2
"""Times the fastest other turn: the rate from which the advice leaves rows out."""


def seam_findings(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """A finding with the runs whose heading was interpolated across its seam; and the runs, divided there
    into parts of FEWEST_ROWS or more."""
    names, places, divided, fastest = [], [], [], 0.0
    for run in runs:
        stretches = _stretches(run)
        if not stretches:
            divided.append(run)
            continue
        names.append(run.name)
        places += [f"{run.time[a]:.1f} to {run.time[b]:.1f} s of {run.name}" for a, b in stretches]
        edges = [0, *(row for a, b in stretches for row in (a, b + 1)), len(run.time)]
        kept = [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a >= FEWEST_ROWS]
        fastest = max([fastest, *(_fastest(run, part) for part in kept)])
        divided += [Run(run.name, {n: v[part] for n, v in run.columns.items()}, run.meta) for part in kept]
    if not names:
        return [], divided
    message = (
        f"is interpolated across its seam, as from 359 to 1 degree through 180, at {len(places)} "
        f"place{'s' * (len(places) > 1)}, first from {places[0]}"
    )
    missing = f"heading=where(abs(turn_rate(heading)) > {CLEAR * fastest:.3g}, 0/0, heading)"
    advice = (
        "interpolate its sine and cosine; or leave these rows out: swamp-rl runs import, of this dataset, "
        f"--map '{missing}' --bad-rows split, where --resample HZ --fill SECONDS keeps the runs whole"
    )
    figures = {"places": float(len(places))}
    return [Finding("fault", "heading_seam", ("heading",), message, advice, tuple(names), figures)], divided


def _stretches(run: Run) -> list[tuple[int, int]]:
    """First and last row of each interpolation across the seam at north or south."""
    heading = run.columns.get("heading")
    steps = np.diff(run.time)
    if heading is None or len(steps) < 3 or not np.isfinite(heading).all() or not (steps > 0.0).all():
        return []
    turns = np.asarray(wrapped(np.diff(heading)))
    rates = np.abs(turns) / steps
    # A sample at the seam's side is followed by a part of a step.
    fast = rates > FAST * float(np.quantile(rates, USUAL))
    edges = np.flatnonzero(np.diff(fast, prepend=False, append=False)).reshape(-1, 2).tolist()
    return [(a, b) for a, b in edges if _is_excursion(heading[[a, b]], turns[a:b])]


def _is_excursion(ends: Array, turns: Array) -> bool:
    """Whether the turns (N,) [rad] go the long way from one end to the other, which are both near north or
    both near south."""
    seam = 0.0 if abs(wrapped(float(ends[0]))) < 0.5 * np.pi else np.pi
    sides = np.asarray(wrapped(ends - seam))
    inner = turns[1:-1]
    even = len(inner) < 2 or float(np.ptp(inner)) <= EVEN * abs(float(np.median(inner)))
    return bool(np.abs(sides).max() < NEAR and np.abs(turns).sum() > FARTHEST and even)


def _fastest(run: Run, part: slice) -> float:
    """The greatest turning rate [rad/s] within a part of a run, as `turn_rate` has it."""
    return float(np.abs(np.gradient(np.unwrap(run.columns["heading"][part]), run.time[part])).max())
