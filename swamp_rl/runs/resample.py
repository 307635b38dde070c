"""A run's columns at even times: what recorders of others' boats seldom keep."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.errors import UserError
from swamp_rl.runs.run import Run

Array = NDArray[np.float64]

MOST_ROWS, MOST_CELLS = 10_000_000, 2 * 10**7
"""Of a resampled run."""
MOST_BETWEEN, ALWAYS = 100, 100_000
"""Rows for each row that was given, and so many of any run: few rows with one wrong time make no long run."""
ANGLES = ("heading", "wind_from")
HELD = ("azimuth_", "throttle_", "rudder_", "propeller_", "joy_", "keep")


def most_rows(columns: int, given: int) -> int:
    """Rows that a resampled run of so many columns and so many given rows has at most."""
    return min(MOST_ROWS, MOST_CELLS // columns, max(MOST_BETWEEN * given, ALWAYS))


@np.errstate(over="ignore", invalid="ignore")  # times near the end of their range make too many rows
def resampled(columns: Mapping[str, Array], rate: float) -> dict[str, Array]:
    """Columns (T,) with increasing times as columns at `rate` [Hz] from the first time on.

    Values are in proportion between rows, angles and longitudes [degrees] the short way round; commands are
    held until the next row.
    UserError for more than `most_rows`.
    """
    time = columns["time"]
    rows = (time[-1] - time[0]) * rate + 1.0 + 1e-9
    most = most_rows(len(columns), len(time))
    if not rows < most:
        raise UserError(
            f"{rows:.3g} rows at {rate:g} a second from {len(time)}, at most {most}; "
            "resample at a lower rate, or divide the run where its times jump"
        )
    even = time[0] + np.arange(math.floor(rows)) / rate
    return {name: at_times(name, time, values, even) for name, values in columns.items()} | {"time": even}


def resampled_run(run: Run, rate: float) -> Run:
    """The run at `rate` [Hz], as `resampled` has it; the entry `resampled` records it. Outcome and other
    entries stay those of the rows before. UserError as from `resampled`."""
    even = resampled(run.columns, rate)
    longest = float(np.diff(run.time).max())
    message = (
        f"{len(run.time)} rows to {len(even['time'])}, {rate:g} a second; "
        f"longest step between rows {longest:.3g} s"
    )
    return Run(run.name, even, run.meta.model_copy(update={"resampled": message}))


def is_held(name: str) -> bool:
    """Whether a column keeps its value until the next row."""
    return name.startswith(HELD)


def at_times(name: str, time: Array, values: Array, even: Array) -> Array:
    """The values (T,) of a column, known at `time` (T,), at other times (N,), as `resampled` has them."""
    if is_held(name):
        return values[np.maximum(np.searchsorted(time, even + 1e-9, side="right") - 1, 0)]
    if name in ANGLES or name.startswith("applied_azimuth_"):
        return wrapped(np.interp(even, time, np.unwrap(values)))
    if name == "longitude" and np.abs(values).max() <= 180.0:  # others are no degrees, which importing tells
        turned = np.interp(even, time, np.unwrap(values, period=360.0))
        return np.where(np.abs(turned) <= 180.0, turned, np.mod(turned + 180.0, 360.0) - 180.0)
    return np.interp(even, time, values)
