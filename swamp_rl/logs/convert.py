"""A log and a mapping as one foreign table: expressions evaluated, clocks aligned, tables joined by time."""

from collections.abc import Mapping as Mapped
from dataclasses import replace
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.logs.clock import clock_offset
from swamp_rl.logs.expression import Name, Node, evaluated, names_in, parsed
from swamp_rl.logs.frames import (
    QUATERNION,
    column_of,
    in_our_frame,
    names_by_column,
    refuse_halves,
)
from swamp_rl.logs.join import Series, joined
from swamp_rl.logs.log import Log, LogTable, words_of
from swamp_rl.logs.mapped_column import (
    MOST_NAMED,
    Column,
    columns_of,
    find,
    of_mixtures,
    resolved,
    values_of,
    with_mixtures,
)
from swamp_rl.logs.mapping import Mapping, is_time
from swamp_rl.logs.sparse_columns import is_sparse, messages_of
from swamp_rl.logs.turns import refuse_beyond_turn, wrapped_where_known
from swamp_rl.runs.bad_rows import first_of
from swamp_rl.runs.check import repeated_times
from swamp_rl.runs.columns import is_angle
from swamp_rl.runs.faults import Fault, condensed, faults_at
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.missing_marks import without_marks
from swamp_rl.runs.resample import ANGLES
from swamp_rl.runs.schema import RunMeta
from swamp_rl.runs.stamps import NO_TIME, PAST_MIDNIGHT, Stamps, from_numbers, from_words, on_one_day
from swamp_rl.runs.table import EMPTY, Table, cell_text
from swamp_rl.runs.units import factor

Array = NDArray[np.float64]
NOMINAL = 0.01
"""Of a rate: an irregular stamp moves the median step by as much, in one log otherwise than in the next."""


def foreign_of(
    log: Log, mapping: Mapping, rate: float | None = None, fill: float = 0.0, counted: float | None = None
) -> Foreign:
    """The table of a run that the mapping makes of the log.

    rate [Hz]: of the joined rows, by default that of the table with the position; the rows of a table
    without times of its own stay as they are, unless it has a sparse column: then its messages are joined.
    fill [s]: pauses of a table that are interpolated. counted [Hz]: of the rows of one table, in place of its
    times. UserError for a column that is not there, a mapping that does not fit together, tables without a
    common time.
    """
    refuse_halves(mapping.columns)
    nodes = {name: node for name, node in mapping.columns.items() if not is_time(name)}
    found, mixed = columns_of(log, nodes)
    for name in mapping.columns.keys() - nodes.keys() - {"time"}:
        if (table := name.rpartition(".")[0]) not in log.tables:
            near = nearest(table, list(log.tables))
            raise UserError(f"{log.file}: --map {name}: there is no table {clipped(table)!r}{near}")
    if not found:
        raise UserError(f"{log.file}: the mapping names no column but time; map north and east, and heading")
    used = list(dict.fromkeys(column.table for column in found.values() if column.table))
    used = used or list(log.tables)[:1]
    log = replace(log, tables={**log.tables, **{n: _without_marks(log, mapping, found, n) for n in used}})
    if counted is not None and (len(used) > 1 or log.tables[used[0]].time is not None):
        raise UserError(f"{log.file}: --rate: counts the rows of one table without times; leave it out")
    stamps = on_one_day({name: _stamps(log, log.tables[name], mapping, counted) for name in used})
    metadata: dict[str, Any] = dict(log.metadata) | _left_out(log, mapping, found, used)
    units = {column_of(name, mapping): unit for name, unit in mapping.units.items() if name in nodes}
    metadata |= {"units": units} if units else {}
    metadata |= {"velocity_axes": "earth"} if {"vx", "velocity_north"} & found.keys() else {}
    times = [one.note for one in stamps.values() if one.note]
    metadata |= {"times": max(times, key=lambda one: PAST_MIDNIGHT in one)} if times else {}
    messages: dict[str, str] = {}
    if len(used) == 1 and log.tables[used[0]].time is None:
        own = {name: values_of(log, mapping, name, one, stamps[used[0]]) for name, one in found.items()}
        messages = messages_of(used[0], own)
        if not messages:
            return _single(log, mapping, found, stamps[used[0]], metadata)
    _refuse_coarse_clocks(log, stamps)
    shifts = _clocks(log, mapping, stamps)
    metadata |= {"clocks": "; ".join(text for _, text in shifts.values())} if shifts else {}
    series = _series(
        log, mapping, found, stamps, {name: shift for name, (shift, _) in shifts.items()}, messages
    )
    series = _without_quaternion(log, series)
    lost = condensed([fault for one in series.values() for _, fault in one.lost])
    metadata |= {"cells_left_out": first_of([str(fault) for fault in lost])} if lost else {}
    for name in series.keys() & {"yaw", *ANGLES}:
        table = found[name if name in found else "qw"].table or used[0]
        refuse_beyond_turn(log, mapping, name, found.get(name), stamps[table], series[name].values)
    rate = rate or _rate(log, series)
    grid = joined(log.file, series, rate, fill)
    columns = _in_our_frame(log, with_mixtures(grid.columns, mixed, mapping), mapping)
    unread = _unread(columns, grid.unread)
    rows = np.arange(1, len(columns["time"]) + 1)
    faults = [_renamed(fault, mapping) for fault in of_mixtures(grid.faults, mixed)]
    table_of_all = Table(columns, rows, unread, faults)
    metadata["joined"] = grid.note
    meta, mapped = RunMeta.model_validate(metadata), names_by_column(mapping)
    return Foreign(log.file, log.name, table_of_all, meta, mapped=mapped, even=True)


def _series(
    log: Log,
    mapping: Mapping,
    found: Mapped[str, Column],
    stamps: Mapped[str, Stamps],
    shifts: Mapped[str, float],
    messages: Mapped[str, str],
) -> dict[str, Series]:
    """The mapped columns at their times, those of tables by their shifts [s]; messages: what those of one
    table are called, where it has sparse columns, whose empty cells are no lost ones."""
    first = min(one.start for one in stamps.values())
    series = {}
    for name, column in found.items():
        table = column.table or next(iter(stamps))
        offset = stamps[table].start - first + shifts.get(table, 0.0)
        time, values = stamps[table].time + offset, values_of(log, mapping, name, column, stamps[table])
        lost = _lost(log, mapping, name, column, time)
        if messages and is_sparse(values):
            lost = [cell for cell in lost if not cell[1].message.startswith(EMPTY)]
        series[name] = Series(messages.get(name, table), time, values, lost)
    return series


def _without_marks(log: Log, mapping: Mapping, found: Mapped[str, Column], table: str) -> LogTable:
    """A table of the log, without the marks of a logger of tables."""
    own = log.tables[table]
    if own.time is not None:
        return own
    angles = [
        theirs
        for name, column in found.items()
        if column.table == table and is_angle(column_of(name, mapping))
        for theirs in column.names.values()
    ]
    return replace(own, table=without_marks(own.origin, own.table, angles))


def _in_our_frame(log: Log, columns: Mapped[str, Array], mapping: Mapping) -> dict[str, Array]:
    """The columns in the axes of a run; a fault names the log."""
    try:
        return in_our_frame(columns, mapping.frame_of)
    except UserError as error:
        raise UserError(f"{log.file}: {error}") from error


def _unread(
    columns: Mapped[str, Array], before: Mapped[str, NDArray[np.bool_]]
) -> dict[str, NDArray[np.bool_]]:
    """Which values are missing for a fault that is reported already, whatever column came of them."""
    if not before:
        return {}
    any_missing = np.any(list(before.values()), axis=0)
    return {name: any_missing & ~np.isfinite(values) for name, values in columns.items()}


def _single(
    log: Log, mapping: Mapping, found: dict[str, Column], stamps: Stamps, metadata: dict[str, Any]
) -> Foreign:
    """Of one table: its rows as they are, with the faults of the cells that the mapping reads."""
    table = log.tables[next((c.table for c in found.values() if c.table), next(iter(log.tables)))].table
    columns = {name: values_of(log, mapping, name, column, stamps) for name, column in found.items()}
    if set(QUATERNION) <= set(columns):
        columns["yaw"] = _yaw(columns)
    if "yaw" in columns:
        refuse_beyond_turn(log, mapping, "yaw", found.get("yaw"), stamps, columns["yaw"])
    for name in columns.keys() & set(ANGLES):
        columns[name] = wrapped_where_known(log, mapping, name, found[name], stamps, columns[name])
    read = {theirs: name for name, column in found.items() for theirs in column.names.values()}
    faults = [
        fault if fault.column is None else _renamed(_mapped(fault, read[fault.column]), mapping)
        for fault in table.faults
        if fault.column is None or fault.column in read
    ]
    missing = np.zeros(table.rows.shape, bool)
    for name in read:
        missing = missing | table.unread.get(name, np.zeros(table.rows.shape, bool))
    columns = {"time": stamps.time} | _in_our_frame(log, columns, mapping)
    unread = {name: missing & ~np.isfinite(values) for name, values in columns.items()}
    if unread["time"].any() or not np.isfinite(stamps.time).all():
        late = ~np.isfinite(stamps.time)
        faults += faults_at(log.file, "time", table.rows, late, lambda i: NO_TIME)
        unread["time"] = late
    whole = Table(columns, table.rows, unread, faults, table.whole)
    return Foreign(
        log.file, log.name, whole, RunMeta.model_validate(metadata), mapped=names_by_column(mapping)
    )


def _lost(log: Log, mapping: Mapping, name: str, column: Column, time: Array) -> list[tuple[float, Fault]]:
    """The cells of a joined table that give a mapped column no value: of the times (T,) theirs [s], and the
    fault."""
    if column.table not in log.tables:
        return []
    table = log.tables[column.table].table
    cells = [
        (float(time[np.searchsorted(table.rows, fault.row)]), _renamed(_mapped(fault, name), mapping))
        for fault in table.faults
        if fault.row is not None and fault.column in column.names.values()
    ]
    return sorted((cell for cell in cells if np.isfinite(cell[0])), key=itemgetter(0))


def _mapped(fault: Fault, ours: str) -> Fault:
    """The fault of a column of the log, of the mapped one that reads it."""
    there = "" if fault.column == ours else f" (there {clipped(fault.column)!r})"
    return replace(fault, column=ours, message=f"{fault.message}{there}")


def _renamed(fault: Fault, mapping: Mapping) -> Fault:
    """The fault of a mapped column, of the column of the run that is made of it."""
    name = str(fault.column)
    return replace(fault, column=column_of(name, mapping))


def _stamps(log: Log, table: LogTable, mapping: Mapping, counted: float | None) -> Stamps:
    """The times of a table: counted [Hz], or as the mapping says, else its own."""
    if counted is not None:
        note = f"counted, {counted:g} rows a second"
        return Stamps(np.arange(len(table.table.rows)) / counted, 0.0, note)
    name = mapping.time_of(table.name)
    where, node = f"--map {name}", mapping.columns.get(name)
    if node is None:
        if table.time is None:
            some = ", ".join(list(table.table.columns)[:MOST_NAMED])
            raise UserError(
                f"{log.file}: the mapping has no time; add --map time=COLUMN (it has {some}), or --rate HZ"
            )
        return Stamps(table.time, 0.0, None)
    words = list(dict.fromkeys(names_in(node)))
    alone = Log(log.file, log.name, {table.name: table})
    if len(log.tables) > 1 and name == "time":
        where += f" of table {table.name} (--map {table.name}.time=COLUMN gives its own)"
    there = {word: find(alone, where, word)[1] for word in words}
    if len(words) == 1 and (cells := words_of(table, there[words[0]])) is not None:
        stamps = from_words(cells)
        if stamps is None:
            cell = clipped(cell_text(cells, 0), 40)
            raise UserError(
                f"{log.file}: {where}: {cell!r} is not a time; give seconds, ticks since 1970 or "
                "ISO 8601 (2026-05-01T12:00:00.100Z), in a spreadsheet the format yyyy-mm-dd hh:mm:ss.000"
            )
        return stamps if isinstance(node, Name) else _shifted(stamps, node, words[0])
    if text := [column for column in there.values() if words_of(table, column) is not None]:
        raise UserError(
            f"{log.file}: {where}: {text[0]!r} has no numbers to reckon with; of a date and a time of day in "
            "two columns give the time of day alone"
        )
    values = evaluated(node, {word: table.table.columns[column] for word, column in there.items()})
    values = np.array(np.broadcast_to(values, table.table.rows.shape))
    unit = mapping.units.get(name)
    return from_numbers(values, f"{log.file}: {where}", factor("time", unit) if unit else None)


def _shifted(stamps: Stamps, node: Node, word: str) -> Stamps:
    """The times that an expression makes of others [s], as `Uhrzeit - 7200` of a clock two hours ahead."""
    values = np.array(np.broadcast_to(evaluated(node, {word: stamps.start + stamps.time}), stamps.time.shape))
    known = values[np.isfinite(values)]
    start = float(known[0]) if len(known) else 0.0
    return replace(
        stamps,
        time=values - start,
        start=start,
        note=f"{stamps.note}, shifted by {start - stamps.start:+.6g} s",
    )


def _refuse_coarse_clocks(log: Log, stamps: Mapped[str, Stamps]) -> None:
    """UserError for a table to be joined by times of which most rows have that of the row before."""
    for name, own in stamps.items():
        if log.tables[name].time is None and (repeated := repeated_times(own.time)):
            raise UserError(
                f"{log.file}: the times of {name} repeat: {repeated}; tables are joined by "
                "their times, give each row its own"
            )


def _without_quaternion(log: Log, series: dict[str, Series]) -> dict[str, Series]:
    """The series with the yaw in place of a quaternion, which must not be interpolated by its parts."""
    if "qw" not in series:
        return series
    tables = {series[name].table for name in QUATERNION}
    if len(tables) > 1:
        raise UserError(
            f"{log.file}: the quaternion is mapped from tables {', '.join(sorted(tables))}; use one"
        )
    parts = {name: series[name].values for name in QUATERNION}
    lost = sorted((cell for name in QUATERNION for cell in series[name].lost), key=itemgetter(0))
    kept = {name: one for name, one in series.items() if name not in QUATERNION}
    return kept | {"yaw": replace(series["qw"], values=_yaw(parts), lost=lost)}


def _yaw(columns: dict[str, Array]) -> Array:
    """The yaw [rad] of the quaternion in columns, which is taken out; NaN where its length is not 1."""
    w, x, y, z = (columns.pop(name) for name in QUATERNION)
    yaw = evaluated(parsed("yaw(w, x, y, z)"), {"w": w, "x": x, "y": y, "z": z})
    return np.where(np.abs(np.sqrt(w * w + x * x + y * y + z * z) - 1.0) < 0.1, yaw, np.nan)


def _rate(log: Log, series: Mapped[str, Series]) -> float:
    """Of the table with the position [Hz], rounded to three digits, or to two within NOMINAL."""
    first = next((series[n] for n in ("north", "x", "latitude") if n in series), next(iter(series.values())))
    steps = np.diff(first.time[np.isfinite(first.values)])
    step = float(np.median(steps)) if len(steps) else 0.0
    if not step > 0.0:
        raise UserError(f"{log.file}: {first.table} has no times that increase; give --resample HZ")
    coarse = float(f"{1.0 / step:.2g}")
    return coarse if abs(coarse * step - 1.0) <= NOMINAL else float(f"{1.0 / step:.3g}")


def _clocks(log: Log, mapping: Mapping, stamps: Mapped[str, Stamps]) -> dict[str, tuple[float, str]]:
    """The offsets [s] to add to the times of tables, as asked by pairs of expressions, and what to tell."""
    found: dict[str, tuple[float, str]] = {}
    settled: set[str] = set()
    for pair in mapping.clock:
        where = f"{log.file}: {pair.where}"
        first, second = (resolved(log, pair.where, node) for node in (pair.one, pair.other))
        for column in (first, second):
            if column.table not in stamps:
                raise UserError(f"{where}: table {column.table or '(none)'} is not used by the mapping")
        if first.table == second.table:
            raise UserError(f"{where}: both are of table {first.table}, which has one clock")
        if second.table in settled:
            raise UserError(
                f"{where}: the clock of {second.table} is settled by an earlier --clock; exchange the two "
                "sides, or leave one of them out"
            )
        settled |= {first.table, second.table}
        begin = min(stamps[first.table].start, stamps[second.table].start)
        records = [_record(log, column, stamps[column.table], begin) for column in (first, second)]
        offset = clock_offset(records[0], records[1], where)
        shift = offset.seconds + found.get(first.table, (0.0, ""))[0]
        message = f"{second.table} shifted by {shift:+.3f} s (correlation {offset.correlation:.2f})"
        found[second.table] = (shift, message)
    return found


def _record(log: Log, column: Column, stamps: Stamps, begin: float) -> tuple[Array, Array]:
    """Times [s] from `begin` and values of a column, where both are finite."""
    time = stamps.time + stamps.start - begin
    values = values_of(log, Mapping(), "clock", column, stamps)
    known = np.isfinite(time) & np.isfinite(values)
    return time[known], values[known]


def _is_constant(values: Array) -> bool:
    """Whether a column has one number in all rows; a column of words has none."""
    return bool(len(values) and np.isfinite(values[0]) and (values == values[0]).all())


def _left_out(log: Log, mapping: Mapping, found: Mapped[str, Column], used: list[str]) -> dict[str, str]:
    """The columns of the tables in use that no expression reads, but those of times and of one value."""
    times = [mapping.columns.get(mapping.time_of(name)) for name in used]
    time = {word for node in times if node for word in names_in(node)}
    read = {(column.table, theirs) for column in found.values() for theirs in column.names.values()}
    others = [
        column if len(log.tables) == 1 else f"{name}.{column}"
        for name in used
        for column in log.tables[name].table.columns
        if (name, column) not in read
        and column not in log.tables[name].clocks
        and not time & {column, f"{name}.{column}"}
        and not _is_constant(log.tables[name].table.columns[column])
    ]
    return {"not_imported": ", ".join(map(clipped, others[:40]))} if others else {}
