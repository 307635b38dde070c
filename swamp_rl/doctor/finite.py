"""Rows without a time and values beyond any measurement, left out before the checks that need numbers."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

LARGEST = 1e20
"""Of any value in any unit, such as a time in nanoseconds since 1970 (1.8e18); its fourth power is finite."""


def finite_runs(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """Findings of infinite and larger values, and the runs that have times: their rows that have one.

    Values that are too large are NaN there. Missing cells (NaN) are left to whoever read the file, except of
    a run without any time.
    """
    places: dict[str, list[tuple[str, int]]] = {}
    kept = []
    for run in runs:
        too_large = {name: np.abs(values) > LARGEST for name, values in run.columns.items()}
        columns = {name: np.where(too_large[name], np.nan, values) for name, values in run.columns.items()}
        timed = np.isfinite(columns.get("time", np.zeros(0)))
        if timed.any():
            kept.append(Run(run.name, {name: values[timed] for name, values in columns.items()}, run.meta))
        elif len(timed):
            too_large["time"] = ~timed
        for name, wrong in too_large.items():
            if wrong.any():
                places.setdefault(name, []).append((run.name, int(np.argmax(wrong)) + 1))
    found = []
    for name, at in places.items():
        (first, row), names = at[0], tuple(run for run, _ in at)
        message = f"holds no number, or one beyond {LARGEST:g}: first at row {row} of {first}"
        advice = "cut these rows (--bad-rows), or leave the channel out"
        found.append(Finding("fault", "no_number", (name,), message, advice, names))
    return found, kept
