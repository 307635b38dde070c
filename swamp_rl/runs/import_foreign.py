"""Tables of others as runs: columns renamed, in SI units, at a fixed rate, and checked as ours are."""

import math
import re
import shlex
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs.bad_rows import REFUSED, BadRows, gap_faults, listed, stretches
from swamp_rl.runs.check import MISSING, NOT_FINITE, ODD_NAME, REPEATS, check_table
from swamp_rl.runs.columns import NO_THRUSTER, REQUIRED, UnknownThrusterError, span_of
from swamp_rl.runs.faults import NO_NUMBER, Fault, condensed, faults_at
from swamp_rl.runs.local_frame import NEAR, Place, distance, to_local
from swamp_rl.runs.resample import ANGLES
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta, of_part
from swamp_rl.runs.stamps import FASTEST, NO_TIME, from_numbers
from swamp_rl.runs.table import EMPTY, Table
from swamp_rl.runs.units import IN_DEGREES, factor

Array = NDArray[np.float64]

NO_FIX = "is 0 with longitude 0, as receivers give it without a fix; cut these rows (--bad-rows cut or split)"

TURN = 2.0 * math.pi + 1e-9
TIME_OF_DAY = re.compile(r"\d\d:\d\d")
ROW_ALONE = (
    "is missing",
    "is not a time",
    "is not a number",
    "no finite number",
    "is more than a turn",
    "cut short",
    "does not come after",
)
"""Words of faults that leaving out their rows can mend."""

OF_TIMES = "is missing", "--unit", REPEATS
"""Words of faults of all times that leaving out rows cannot mend."""


@dataclass(frozen=True)
class Foreign:
    """A table as a file has it, columns under their names there; `meta` and `dataset` are what the file
    itself tells of the run and its dataset, where it does, and `copies` the files of its boat and course;
    `home` is the folder of a dataset whose copies lie beside the file; `mapped`: the names that a mapping has
    for the columns that it made; `even`: its rows are those of an even grid already."""

    file: str
    name: str
    table: Table
    meta: RunMeta = field(default_factory=RunMeta)
    dataset: DatasetMeta | None = None
    copies: Mapping[str, bytes] = field(default_factory=dict)
    home: Path | None = None
    mapped: Mapping[str, str] = field(default_factory=dict)
    even: bool = False


@dataclass(frozen=True)
class Wishes:
    """How to read a foreign table: `renamed` their names by ours; `units` (of UNITS) by our names;
    `dropped` their names of columns to leave out; `rate` [Hz] at which rows come, where they have no times to
    be used; `resample` [Hz]; `origin` of north and east, by default the first place of the first table;
    `bad_rows` and `fill` [s] as `stretches` has them; `earlier` [s] by which commands are taken earlier."""

    renamed: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    dropped: tuple[str, ...] = ()
    rate: float | None = None
    resample: float | None = None
    origin: Place | None = None
    bad_rows: BadRows = "refuse"
    fill: float = 0.0
    earlier: float = 0.0


def runs_from(found: Foreign, wishes: Wishes, boat: Boat, origins: Sequence[Place] = ()) -> list[Run]:
    """The runs in a foreign table, as logged: one, or several where it is split at its bad rows.

    origins: of tables imported before; the first one within NEAR of the table's first place is its origin,
    where `wishes` name none.
    Headings and wind directions of up to a full turn are brought into (−π, π]; all else stays as it is.
    UserError lists the faults with file, row, column and what to do.
    """
    if found.even:
        wishes = replace(wishes, rate=None, resample=None, fill=0.0)
    columns, faults, unread = _renamed(found, wishes)
    rows, metadata = found.table.rows, found.meta.model_dump(exclude={"file", "rows"})
    if not found.table.columns:
        refuse(found, wishes, faults)
    late = _to_our_units(found, wishes, columns, metadata)
    if any(fault.row is not None for fault in late):
        unread["time"] = ~np.isfinite(columns["time"])
    faults += late
    more, place = _place(found, columns, unread, wishes.origin, origins)
    faults, metadata = faults + more, metadata | place
    stated = (found.meta.model_extra or {}).get("units", {}) | wishes.units
    faults += _wrap_angles(found, {name for name in ANGLES if stated.get(name) == "deg"}, columns, unread)
    faults += check_table(found.file, Table(columns, rows, unread), boat, None)
    faults += _spelled_otherwise(found, list(columns), boat)
    if wishes.bad_rows == "refuse":
        time = columns.get("time", np.zeros(2))
        if wishes.resample is not None and bool(np.all(np.diff(time) > 0.0)):
            # Uneven steps are what resampling is for, gaps and steps back are not.
            faults = [fault for fault in faults if fault.row is not None or not _is_of_rate(fault)]
            faults = [fault for fault in faults if not _of_steps(fault)]
            faults += gap_faults(found.file, time, rows, wishes.fill)
        refuse(found, wishes, faults)
        return [Run(found.name, columns, RunMeta.model_validate(metadata))]
    refuse(found, wishes, [fault for fault in faults if fault.row is None and not _is_of_rate(fault)])
    wrong = [fault for fault in faults if fault.row is not None and not _of_steps(fault)]
    even = wishes.resample is None
    kept = stretches(found.file, columns, rows, wrong, wishes.bad_rows, even, wishes.fill)
    metadata |= {"rows_left_out": kept.cut} if kept.cut else {}
    runs = []
    for number, part in enumerate(kept.kept, 1):
        name = found.name if wishes.bad_rows == "cut" else f"{found.name}-{number}"
        taken = {column: values[part] for column, values in columns.items()}
        refuse(
            found, wishes, [f for f in check_table(found.file, Table(taken, rows[part]), boat, None) if even]
        )
        own = of_part(metadata, first=part[0] == 0, last=part[-1] == len(rows) - 1)
        runs.append(Run(name, taken, RunMeta.model_validate(own)))
        metadata.pop("rows_left_out", None)
    return runs


def _to_our_units(
    found: Foreign, wishes: Wishes, columns: dict[str, Array], metadata: dict[str, Any]
) -> list[Fault]:
    """Bring columns and times into our units, and return the faults of times that are none."""
    for name, unit in wishes.units.items():
        if name not in columns:
            raise UserError(f"{found.file}: has no column {name} to be given in {unit}; check the name")
        if name != "time" or not _has_stamps(found):
            columns[name] = columns[name] * factor(name, unit)
    metadata |= {"units": dict(wishes.units)} if wishes.units else {}
    if wishes.rate is not None:
        columns["time"] = np.arange(len(found.table.rows)) / wishes.rate
        metadata["times"] = f"counted, {wishes.rate:g} rows a second"
        return []
    late = _to_seconds(found, wishes, columns, metadata) if "time" in columns and _has_stamps(found) else []
    refuse(found, wishes, _times_in_days(found.file, columns.get("time", np.zeros(0))))
    return late


def _to_seconds(
    found: Foreign, wishes: Wishes, columns: dict[str, Array], metadata: dict[str, Any]
) -> list[Fault]:
    """Bring times into seconds, ticks since 1970 into those from the first on, and return the faults of times
    that are none."""
    stamps, unit = columns["time"], wishes.units.get("time")
    asked = factor("time", unit) if unit else None
    try:
        times = from_numbers(stamps, found.file, asked)
    except UserError as error:
        return [Fault(found.file, None, "time", str(error).removeprefix(f"{found.file}: "))]
    columns["time"] = stamps * (asked or 1.0) if times.note is None else times.time
    metadata |= {"times": times.note} if times.note else {}
    late = np.isfinite(stamps) & ~np.isfinite(columns["time"])
    return faults_at(found.file, "time", found.table.rows, late, lambda i: NO_TIME)


def _has_stamps(found: Foreign) -> bool:
    """Whether times of a table are as a logger of others wrote them."""
    return not found.mapped and found.dataset is None


def _wrap_angles(
    found: Foreign, stated: Collection[str], columns: dict[str, Array], unread: dict[str, NDArray[np.bool_]]
) -> list[Fault]:
    """Bring headings and wind directions of up to a full turn into (−π, π], where most of a column are; the
    faults of rows beyond a turn in columns stated to be in degrees."""
    faults: list[Fault] = []
    for name in ANGLES:
        values = columns.get(name, np.zeros(0))
        known = values[np.isfinite(values)]
        if len(known) and np.median(np.abs(known)) <= TURN:
            turned = (np.abs(values) <= TURN) & ~((values > -math.pi) & (values <= math.pi))
            columns[name] = values.copy()
            columns[name][turned] = wrapped(values[turned])
        if name in stated:
            beyond = np.isfinite(values) & (np.abs(values) > TURN)

            def message(i: int, values: Array = values) -> str:
                return f"{math.degrees(values[i]):.6g} deg is more than a turn; correct it or cut the row"

            faults += faults_at(found.file, name, found.table.rows, beyond, message)
            unread[name] = unread.get(name, np.zeros(len(values), bool)) | beyond
            columns[name] = np.where(beyond, np.nan, columns[name])
    return faults


def _spelled_otherwise(found: Foreign, names: Sequence[str], boat: Boat) -> list[Fault]:
    """The faults of columns that the run format has in small letters and without spaces; `check_table` tells
    of those that a run must have."""
    faults = []
    for name in names:
        ours = name.strip().lower()
        if ours not in {*names, *REQUIRED} and _is_known(ours, boat) and not _is_known(name, boat):
            where = " in the mapping" if found.mapped else f": --column {ours}={shlex.quote(name)}"
            message = f"is {ours} of the run format; name it so{where}"
            faults.append(Fault(found.file, None, name, message))
    return faults


def _is_known(name: str, boat: Boat) -> bool:
    try:
        return span_of(name, boat) is not None
    except UnknownThrusterError:
        return False


def _times_in_days(file: str, time: Array) -> list[Fault]:
    """The fault of times that cannot be seconds, as a spreadsheet's, which counts days."""
    steps = np.diff(time[np.isfinite(time)])
    step = float(np.median(steps)) if len(steps) else 0.0
    if not 0.0 < step < FASTEST:
        return []
    message = f"the rows are {step:.3g} s apart, as of times in days; give them in s (--unit time=d)"
    return [Fault(file, None, "time", message)]


def _is_of_rate(fault: Fault) -> bool:
    """Whether leaving out rows may mend a fault of all times."""
    return fault.column == "time" and not any(words in fault.message for words in OF_TIMES)


def _of_steps(fault: Fault) -> bool:
    return fault.column == "time" and ("the row before" in fault.message or "come after" in fault.message)


def _renamed(
    found: Foreign, wishes: Wishes
) -> tuple[dict[str, Array], list[Fault], dict[str, NDArray[np.bool_]]]:
    """Columns under our names, the faults of their cells, and which cells these are."""
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
    unread = {ours.get(name, name): mask for name, mask in found.table.unread.items() if name in kept}
    return {ours.get(name, name): values for name, values in kept.items()}, faults, unread


def refuse(found: Foreign, wishes: Wishes, faults: Sequence[Fault]) -> None:
    """Raise the faults of a table, each with the column's name in the file and the option that may help."""
    if faults:
        lines = [_with_hint(wishes, fault, found.mapped) for fault in condensed(faults)]
        raise UserError(listed(lines, REFUSED))


def _with_hint(wishes: Wishes, fault: Fault, mapped: Mapping[str, str]) -> str:
    name = mapped.get(fault.column or "", fault.column)
    theirs = wishes.renamed.get(fault.column or "")
    hint = f" (there {theirs!r})" if theirs else ""
    if fault.column in REQUIRED and MISSING in fault.message:
        column = "" if mapped else f"--column {fault.column}=THEIRS, or "
        hint = f", or name it: {column}--map {fault.column}=THEIRS (--list shows what is there)"
        if fault.column in ("north", "east"):
            hint += f"; if the log has velocities alone: --map '{fault.column}=integral(VELOCITY)'"
    elif fault.column == "time" and REPEATS in fault.message:
        hint += " (--rate HZ counts rows at a constant rate)"
    elif fault.column == "time" and "resample" in fault.message:
        hint += " (--resample HZ), or divide it (--bad-rows split)"
    elif ODD_NAME in fault.message:
        hint += f" ({option_of('--drop ', fault.column)})"
    elif NO_THRUSTER in fault.message:
        hint += " (--map, --boat)" if mapped else " (--map or --column, --drop, --boat)"
    elif "degrees" in fault.message and fault.column not in IN_DEGREES:
        hint += f" (--unit {name}=deg/s)" if fault.column == "yaw_rate" else f" (--degrees {name})"
    elif "percent" in fault.message:
        hint += f" (--unit {name}=percent)"
    elif "is not a number" in fault.message and TIME_OF_DAY.search(fault.message):
        hint += f", or read it as times: {option_of('--map time=', theirs or fault.column)}"
    elif "is not a number" in fault.message and fault.column not in REQUIRED:
        drop = f": {option_of('--drop ', theirs or fault.column)}"
        hint += f", or leave the column out{' of the mapping' if mapped else drop}"
    elif fault.row is None or "--bad-rows" in fault.message:
        return f"{fault}{hint}"
    elif NOT_FINITE in fault.message:
        hint += " (--bad-rows cut or split; --bad-rows split --resample HZ --fill SECONDS interpolates)"
    elif any(words in fault.message for words in ROW_ALONE):
        hint += " (--bad-rows cut or split)"
        hint += "; --map joins columns that come in some rows only" if _is_seldom(fault, mapped) else ""
    return f"{fault}{hint}"


def _is_seldom(fault: Fault, mapped: Mapping[str, str]) -> bool:
    """Whether a column is empty in several stretches of rows that were imported without a mapping."""
    return bool(fault.alike) and not mapped and fault.message.startswith(EMPTY)


def option_of(words: str, column: str | None) -> str:
    """An option of `runs import` that ends in a column's name, as a shell and `--map` take it."""
    name = str(column)
    option, space, begin = words.partition(" ")
    return f"{option}{space}{shlex.quote(begin + (in_expression(name) if begin else name))}"


def in_expression(name: str) -> str:
    """A column's name as an expression takes it."""
    return name if re.fullmatch(r"[^\W\d][\w.]*", name) else f"`{name}`"


def _place(
    found: Foreign,
    columns: dict[str, Array],
    unread: dict[str, NDArray[np.bool_]],
    origin: Place | None,
    origins: Sequence[Place],
) -> tuple[list[Fault], dict[str, Any]]:
    """North and east from latitude and longitude [degrees], where the table has these only: the faults of
    these, and what to tell. A place of exactly 0, 0 is what receivers give without a fix. UserError for an
    origin of a table that has north."""
    both = ("latitude", "longitude")
    if "north" in columns and origin is not None:
        raise UserError(
            f"{found.file}: has north and east, so --origin cannot act; leave it out, or drop these"
        )
    if "north" in columns or not set(both) <= set(columns) or not len(found.table.rows):
        return [], {}
    known = ~np.any([unread.get(name, np.zeros(len(found.table.rows), bool)) for name in both], axis=0)
    faults, rows = [], found.table.rows
    for name, most in (("latitude", 90.0), ("longitude", 180.0)):
        values = columns[name]
        wrong = ~(np.abs(values) <= most) & known

        def message(i: int, values: Array = values, name: str = name, most: float = most) -> str:
            nmea = abs(values[i]) <= 100.0 * most + 60.0
            hint = "; of NMEA's ddmm.mmmm, the two digits before the point and those behind it are minutes"
            return f"{values[i]:.9g} is no {name} in degrees; correct it{hint if nmea else ''}"

        faults += faults_at(found.file, name, rows, wrong, message)
        known &= ~wrong
    none = (columns["latitude"] == 0.0) & (columns["longitude"] == 0.0) & known
    if not none.all():
        faults += faults_at(found.file, "latitude", rows, none, lambda i: NO_FIX)
        known &= ~none
    if not known.any():
        columns |= {name: np.full(len(rows), np.nan) for name in ("north", "east")}
        unread |= dict.fromkeys(("north", "east"), ~known)
        return faults or [Fault(found.file, None, "latitude", NO_NUMBER)], {}
    first = int(np.argmax(known))
    start = float(columns["latitude"][first]), float(columns["longitude"][first])
    origin = origin or next((one for one in origins if distance(start, one) <= NEAR), start)
    north, east = to_local(columns["latitude"][known], columns["longitude"][known], origin)
    for name, values in (("north", north), ("east", east)):
        columns[name] = np.full(len(rows), np.nan)
        columns[name][known] = values
        unread[name] = ~known
    return faults, {"origin": {"latitude": origin[0], "longitude": origin[1]}}
