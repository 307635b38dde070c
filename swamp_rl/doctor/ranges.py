"""Columns whose size shows another unit: degrees, percent, pulse widths."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.runs.check import LARGEST_RUDDER, TURN, command_counts_turns, counts_turns
from swamp_rl.runs.geographic import METRES_PER_DEGREE, MOST_LATITUDE, in_degrees

Array = NDArray[np.float64]

ANGLES = ("heading", "wind_from", "azimuth_", "rudder_", "applied_azimuth_", "applied_rudder_")
LEVELS = ("throttle_", "applied_throttle_", "joy_")
SCALES = ((1.5, 105.0, 0.01, "percent"), (105.0, 2500.0, 1.0 / 400.0, "pulse widths in microseconds"))
"""Span of the largest value of a level, what one of it is, and its name; a level in our unit is at most 1."""


def range_findings(runs: Sequence[Run]) -> tuple[list[Finding], list[Run]]:
    """Columns in degrees, percent or microseconds, and the runs with these in our units."""
    found, factors = _position_findings(runs)
    for name in dict.fromkeys(name for run in runs for name in run.columns):
        having = [run for run in runs if name in run.columns and np.isfinite(run.columns[name]).any()]
        if not having:
            continue
        values = np.concatenate([run.columns[name] for run in having])
        values = values[np.isfinite(values)]
        largest = float(np.abs(values).max())
        if name.startswith(ANGLES) and _in_degrees(name, having, largest):
            message = f"reaches {largest:.4g}, beyond what an angle in radians can be there"
            found.append(_fault(name, message, f"give it in radians (--degrees {name})", largest))
            factors[name] = math.pi / 180.0
        elif name == "yaw_rate" and float(np.quantile(np.abs(values), 0.99)) > math.tau:
            message = f"reaches {largest:.4g} rad/s, more than a turn a second"
            found.append(_fault(name, message, "give it in rad/s (--unit yaw_rate=deg/s)", largest))
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


def _position_findings(runs: Sequence[Run]) -> tuple[list[Finding], dict[str, float]]:
    """Positions that are latitude and longitude in every run that has any and does not stand still, and the
    factors that make metres of them.
    """
    having = [run for run in runs if {"north", "east"} <= run.columns.keys()]
    every = [np.array([run.columns["north"], run.columns["east"]]) for run in having]
    known = [place[:, np.isfinite(place).all(axis=0)] for place in every]
    places = [place for place in known if place.size and np.ptp(place, axis=1).any()]
    if not places or not all(in_degrees(north, east) for north, east in places):
        return [], {}
    north, east = np.median(np.concatenate(places, axis=1), axis=1)
    span = max(float(np.ptp(place, axis=1).max()) for place in places)
    swapped = abs(north) > MOST_LATITUDE
    names = ("longitude", "latitude") if swapped else ("latitude", "longitude")
    message = f"span {span:.2g} m at most, about {north:.6g} and {east:.6g}, as latitude and longitude do"
    advice = f"map them as {names[0]} and {names[1]} in runs import, which makes metres of them"
    shorter = METRES_PER_DEGREE * math.cos(math.radians(float(east if swapped else north)))
    factors = (shorter, METRES_PER_DEGREE) if swapped else (METRES_PER_DEGREE, shorter)
    finding = Finding("fault", "unit", ("north", "east"), message, advice, figures={"span": span})
    return [finding], dict(zip(("north", "east"), factors, strict=True))


def _fault(name: str, message: str, advice: str, largest: float) -> Finding:
    return Finding("fault", "unit", (name,), message, advice, figures={"largest": largest})


def _in_degrees(name: str, runs: Sequence[Run], largest: float) -> bool:
    if "rudder_" in name:
        return largest > LARGEST_RUDDER + 1e-6
    if largest <= TURN:
        return False
    if name == "heading":
        return any(not counts_turns(run.columns[name], run.time, farthest=TURN) for run in runs)
    return any(not command_counts_turns(run.columns[name], run.time) for run in runs)


def _scaled(run: Run, factors: dict[str, float]) -> Run:
    columns = {
        name: values * factors[name] if name in factors else values for name, values in run.columns.items()
    }
    return Run(run.name, columns, run.meta)
