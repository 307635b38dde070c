"""Positions that jump: a row far from both the one before and where the boat can have gone."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

USUAL = 0.95
"""Quantile of the speeds from row to row that the jumps are compared with."""
JUMP = 20.0
"""Times that speed: white noise has no step beyond four times its quantile."""


def jump_findings(runs: Sequence[Run]) -> list[Finding]:
    """A finding with the runs whose position goes from one row to the next JUMP times as fast as it does in
    USUAL of the steps."""
    names, first, longest = [], "", 0.0
    for run in runs:
        if not {"north", "east"} <= set(run.columns) or len(run.time) < 3:
            continue
        moved = np.hypot(np.diff(run.columns["north"]), np.diff(run.columns["east"]))
        steps = np.diff(run.time)
        known = np.isfinite(moved) & (steps > 0.0)
        speed = np.where(known, moved, 0.0) / np.where(known, steps, 1.0)
        usual = float(np.quantile(speed[known], USUAL)) if known.any() else 0.0
        wrong = speed > JUMP * usual
        if usual > 0.0 and wrong.any():
            row = int(np.argmax(wrong))
            first = first or f"{moved[row]:.3g} m, at {run.time[row + 1]:.1f} s of {run.name}"
            longest = max(longest, float(moved[wrong].max()))
            names.append(run.name)
    if not names:
        return []
    told = f"jumps from one row to the next, first by {first}"
    advice = "leave these rows out and import again (--bad-rows cut or split)"
    columns, figures = ("north", "east"), {"longest_jump_m": longest}
    return [Finding("fault", "position_jump", columns, told, advice, tuple(names), figures)]
