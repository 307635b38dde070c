"""Columns whose size shows another unit: degrees, percent, pulse widths."""

import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

ANGLES = ("heading", "wind_from", "azimuth_", "rudder_", "applied_azimuth_", "applied_rudder_")
LEVELS = ("throttle_", "applied_throttle_", "joy_")
LARGEST_RUDDER = 0.5 * math.pi
"""rad: no rudder turns further."""
SCALES = ((1.5, 105.0, 0.01, "percent"), (105.0, 2500.0, 1.0 / 400.0, "pulse widths in microseconds"))
"""Span of the largest value of a level, what one of it is, and its name; a level in our unit is at most 1."""


def range_findings(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """Columns in degrees, percent or microseconds, and the runs with these in our units."""
    found = []
    factors: dict[str, float] = {}
    for name in runs[0].columns if runs else ():
        parts = [run.columns[name] for run in runs if name in run.columns]
        values = np.concatenate(parts)
        values = values[np.isfinite(values)]
        if not len(values):
            continue
        largest = float(np.abs(values).max())
        if name.startswith(ANGLES) and _in_degrees(name, parts, largest):
            told = f"reaches {largest:.4g}, beyond what an angle in radians can be there"
            found.append(_fault(name, told, f"give it in radians (--degrees {name})", largest))
            factors[name] = math.pi / 180.0
        elif name == "yaw_rate" and float(np.quantile(np.abs(values), 0.99)) > math.tau:
            told = f"reaches {largest:.4g} rad/s, more than a turn a second"
            found.append(_fault(name, told, "give it in rad/s (--unit yaw_rate=deg/s)", largest))
            factors[name] = math.pi / 180.0
        elif name.startswith(LEVELS):
            for low, high, factor, unit in SCALES:
                if low < largest <= high:
                    advice = f"divide by full command (--unit {name}=percent, or --map)"
                    found.append(_fault(name, f"reaches {largest:.4g}, as {unit} do, not 1", advice, largest))
                    factors[name] = factor
    if not factors:
        return found, list(runs)
    return found, [_scaled(run, factors) for run in runs]


def _fault(name: str, told: str, advice: str, largest: float) -> Finding:
    return Finding("fault", "unit", (name,), told, advice, figures={"largest": largest})


def _in_degrees(name: str, parts: Sequence[np.ndarray], largest: float) -> bool:
    if "rudder_" in name:
        return largest > LARGEST_RUDDER + 1e-6
    if largest <= math.tau + 1e-6:
        return False
    # An angle that counts its turns passes a full turn in steps that are small.
    jumps = np.concatenate([np.abs(np.diff(values[np.isfinite(values)])) for values in parts])
    starts = max(abs(float(values[0])) for values in parts)
    return bool(starts > math.tau or (len(jumps) and jumps.max() > math.tau + 1e-6) or largest > 90.0)


def _scaled(run: Run, factors: dict[str, float]) -> Run:
    columns = {
        name: values * factors[name] if name in factors else values for name, values in run.columns.items()
    }
    return Run(run.name, columns, run.meta)
