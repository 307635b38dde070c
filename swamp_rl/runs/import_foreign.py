"""Tables of others as runs: columns renamed, in SI units, at a fixed rate, and checked as ours are."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs.check import check_table
from swamp_rl.runs.columns import REQUIRED
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.local_frame import Place, to_local
from swamp_rl.runs.resample import ANGLES, resampled, wrapped
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.runs.table import Table

Array = NDArray[np.float64]

UNITS = {
    "deg": math.pi / 180.0,
    "deg/s": math.pi / 180.0,
    "rpm": 1.0 / 60.0,
    "percent": 0.01,
    "mm": 1e-3,
    "cm": 1e-2,
    "km": 1e3,
    "ft": 0.3048,
    "kn": 1852.0 / 3600.0,
    "km/h": 1.0 / 3.6,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
}
"""What one of each is in the unit of the run format."""


@dataclass(frozen=True)
class Foreign:
    """A table as a file has it, columns under their names there; `meta` and `dataset` are what the file
    itself tells of the run and its dataset, where it does, and `copies` the files of its boat and course."""

    file: str
    name: str
    table: Table
    meta: RunMeta = field(default_factory=RunMeta)
    dataset: DatasetMeta | None = None
    copies: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Wishes:
    """How to read a foreign table: `renamed` their names by ours; `units` (keys of `UNITS`) by our names;
    `dropped` their names of columns to leave out; `rate` [Hz] at which rows come, where they have no times to
    be used; `resample` [Hz]; `origin` of north and east, by default the first place."""

    renamed: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    dropped: tuple[str, ...] = ()
    rate: float | None = None
    resample: float | None = None
    origin: Place | None = None


def run_from(found: Foreign, wishes: Wishes, boat: Boat) -> Run:
    """The run in a foreign table; UserError with file, row and column at its first fault.

    Headings and wind directions of up to a full turn are brought into (−π, π]; all else stays as it is.
    """
    columns, faults = _renamed(found, wishes)
    _refuse(wishes, faults)
    rows, told = found.table.rows, found.meta.model_dump(exclude={"file", "rows"})
    for name, unit in wishes.units.items():
        if name not in columns:
            raise UserError(f"{found.file}: has no column {name} to be given in {unit}; check the name")
        columns[name] = columns[name] * UNITS[unit]
    if wishes.rate is not None:
        columns["time"] = np.arange(len(rows)) / wishes.rate
        told["times"] = f"counted, {wishes.rate:g} rows a second"
    told |= _place(found, columns, wishes.origin)
    for name in ANGLES:
        if name in columns and np.all(np.abs(columns[name]) <= 2.0 * math.pi + 1e-9):
            inside = (columns[name] > -math.pi) & (columns[name] <= math.pi)
            columns[name] = np.where(inside, columns[name], wrapped(columns[name]))
    faults = check_table(found.file, Table(columns, rows), boat, None)
    if wishes.resample is None:
        _refuse(wishes, faults)
    else:
        # Uneven steps are what resampling is for, steps back are not.
        forward = bool(np.all(np.diff(columns.get("time", np.zeros(2))) > 0.0))
        _refuse(wishes, [fault for fault in faults if fault.column != "time" or not forward])
        columns = resampled(columns, wishes.resample)
        told["resampled"] = f"{len(rows)} rows to {len(columns['time'])}, {wishes.resample:g} a second"
    return Run(found.name, columns, RunMeta.model_validate(told))


def _renamed(found: Foreign, wishes: Wishes) -> tuple[dict[str, Array], list[Fault]]:
    """Columns under our names, and the faults of their cells."""
    there = found.table.columns
    for option, names in (("--column", wishes.renamed.values()), ("--drop", wishes.dropped)):
        for name in names:
            if there and name not in there:
                some = ", ".join(list(there)[:12])
                raise UserError(f"{found.file}: has no column {name!r}; check {option} (it has {some})")
    ours = {theirs: our for our, theirs in wishes.renamed.items()}
    kept = {name: values for name, values in there.items() if name not in wishes.dropped}
    for our, theirs in wishes.renamed.items():
        if our in kept and our not in ours:
            raise UserError(f"{found.file}: has its own column {our} beside {theirs!r}; add --drop {our}")
    faults = [
        replace(fault, column=fault.column and ours.get(fault.column, fault.column))
        for fault in found.table.faults
        if fault.column is None or fault.column in kept
    ]
    return {ours.get(name, name): values for name, values in kept.items()}, faults


def _refuse(wishes: Wishes, faults: list[Fault]) -> None:
    """Raise the first of the faults, with the column's name in the file and the option that may help."""
    for fault in faults[:1]:
        theirs = wishes.renamed.get(fault.column or "")
        hint = f" (there {theirs!r})" if theirs else ""
        if fault.column in REQUIRED and "is missing; add it" in fault.message:
            hint = f", or name it: --column {fault.column}=THEIRS"
        elif fault.column == "time" and "resample" in fault.message:
            hint += " (--resample HZ)"
        elif "degrees" in fault.message:
            hint += f" (--degrees {fault.column})"
        elif "is not a number" in fault.message:
            hint += f", or leave the column out: --drop {theirs or fault.column}"
        raise UserError(f"{fault}{hint}; nothing was imported")


def _place(found: Foreign, columns: dict[str, Array], origin: Place | None) -> dict[str, Any]:
    """North and east from latitude and longitude [degrees], where the table has these only; what to tell."""
    if "north" in columns or not {"latitude", "longitude"} <= set(columns):
        return {}
    for name, most in (("latitude", 90.0), ("longitude", 180.0)):
        wrong = np.flatnonzero(~(np.abs(columns[name]) <= most))
        if len(wrong):
            row, value = int(found.table.rows[wrong[0]]), columns[name][wrong[0]]
            raise UserError(f"{Fault(found.file, row, name, f'{value:.9g} is no {name} in degrees')}")
    if len(found.table.rows) == 0:
        return {}
    origin = origin or (float(columns["latitude"][0]), float(columns["longitude"][0]))
    columns["north"], columns["east"] = to_local(columns["latitude"], columns["longitude"], origin)
    return {"origin": {"latitude": origin[0], "longitude": origin[1]}}
