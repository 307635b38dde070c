"""A helm's log as a dataset of runs, and its figures."""

import math
from pathlib import Path

import numpy as np

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.errors import UserError
from swamp_rl.link.helm import PERIOD, Voyage
from swamp_rl.link.stream import SENSES
from swamp_rl.runs.import_dataset import About, import_tables
from swamp_rl.runs.import_foreign import Foreign, Wishes
from swamp_rl.runs.schema import DatasetMeta
from swamp_rl.runs.table import Table

FILL = 0.25
"""Seconds without telemetry that are interpolated in the log; a longer gap divides the run."""
NAME = "helm"  # of the run
EVEN = 1e-4
"""Seconds by which a step between rows may differ from the period."""


def write_voyage(out: Path, voyage: Voyage, boat: Boat, about: About) -> DatasetMeta:
    """Write the rows of a voyage as a new dataset `out`; what it then says.

    Where telemetry was lost, the rows are resampled at the commands' rate and divided at longer gaps.
    UserError where there are no ten rows in a row, or where `out` exists.
    """
    columns = columns_of(voyage, boat)
    rows = np.arange(1, len(voyage.rows) + 1)
    even = len(rows) > 1 and np.allclose(np.diff(columns["time"]), PERIOD, rtol=0.0, atol=EVEN)
    wishes = Wishes() if even else Wishes(resample=1.0 / PERIOD, bad_rows="split", fill=FILL)
    return import_tables([Foreign(NAME, NAME, Table(columns, rows))], out, about, wishes)


def columns_of(voyage: Voyage, boat: Boat) -> dict[str, np.ndarray]:
    """Columns of a run by name."""
    values = np.array(voyage.rows).T
    if not values.size:
        raise UserError("the log would be empty: no telemetry was answered; nothing was written")
    columns = dict(zip(("time", *SENSES, "joy_thrust", "joy_angle"), values, strict=False))
    columns["heading"] = wrapped(columns["heading"])
    angles, levels = np.split(values[1 + len(SENSES) + 2 :], 2)
    for thruster, angle, level in zip(boat.thrusters, angles, levels, strict=True):
        for column, found in zip(thruster.command_columns, (angle, level), strict=True):
            if column is not None:
                columns[column] = found
    return columns


def start_text(voyage: Voyage, course: Course) -> str:
    """Where the boat was at first, against the course's start, and the first gates that lay behind it."""
    north, east = (float(value) for value in voyage.rows[0][1:3])
    pose, behind = course.start.pose, list[str]()
    for gate in course.gates:
        along = (north - gate.centre.north) * math.cos(gate.heading)
        if along + (east - gate.centre.east) * math.sin(gate.heading) < 0.0:
            break
        behind.append(gate.name)
    away = math.hypot(north - pose.north, east - pose.east)
    beyond = f", beyond gate {' and gate '.join(behind)}" if behind else ""
    return f"began {away:.3g} m from the start of the course{beyond}"


def lateness_figures(voyage: Voyage) -> dict[str, float]:
    """Mean, 99th percentile and greatest lateness of the commands against their schedule [s]; NaN without
    commands."""
    if not voyage.lateness:
        return dict.fromkeys(("mean", "p99", "max"), math.nan)
    late = np.array(voyage.lateness)
    return {"mean": float(late.mean()), "p99": float(np.quantile(late, 0.99)), "max": float(late.max())}
