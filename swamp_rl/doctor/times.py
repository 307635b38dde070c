"""Times that come again, go back or jump."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

JUMP = 1.5
"""Median steps: half a row more than the next row can be late by."""


def time_findings(runs: Sequence[Run]) -> list[Finding]:
    """One finding for each kind of wrong step between rows, with the runs that have it."""
    kinds: dict[str, list[tuple[str, int, float]]] = {"again": [], "back": [], "jump": []}
    for run in runs:
        if len(run.time) < 3:
            continue
        steps = np.diff(run.time)
        forward = steps[steps > 0.0]
        usual = float(np.median(forward)) if len(forward) else 0.0
        for kind, wrong in (
            ("again", steps == 0.0),
            ("back", steps < 0.0),
            ("jump", steps > JUMP * usual),
        ):
            if wrong.any():
                first = int(np.argmax(wrong))
                kinds[kind].append((run.name, first + 2, float(np.abs(steps[wrong]).max())))
    words = {
        "again": ("time_repeated", "the same time comes twice", "cut the second row (--bad-rows)"),
        "back": ("time_back", "time decreases", "split the runs there (--bad-rows split)"),
        "jump": (
            "time_jump",
            "rows are missing",
            "split there (--bad-rows split), or resample (--resample HZ)",
        ),
    }
    found = []
    for kind, places in kinds.items():
        if places:
            code, message, advice = words[kind]
            name, row, size = places[0]
            message = f"{message}: first at row {row} of {name}" + (
                f", a step of {size:.3g} s" if size else ""
            )
            names = tuple(name for name, _, _ in places)
            found.append(Finding("fault", code, ("time",), message, advice, names, {"largest_step_s": size}))
    return found
