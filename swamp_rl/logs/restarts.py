"""Parts of a log between restarts of its clock."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.logs.log import Log, LogTable

BACK = 1.0
"""s by which times go back at a restart, at least; late messages go back by less."""


def parts_between_restarts(log: Log) -> list[Log]:
    """The log, or its parts named NAME-1, NAME-2 where its times go back: a second boot, a clock
    that was set.

    The number of parts is that of most tables of several rows. Tables with another number are left out:
    which part their rows belong to is not known. Where most have one, the log stays whole.
    """
    begins = {name: _begins(table) for name, table in log.tables.items()}
    counts = [len(rows) for name, rows in begins.items() if len(log.tables[name].table.rows) > 1]
    count = int(np.bincount(counts).argmax()) if counts else 1
    if count == 1:
        return [log]
    whole = {name: rows for name, rows in begins.items() if len(rows) == count}
    parts = []
    for k in range(count):
        tables = {
            name: _rows(log.tables[name], rows[k], rows[k + 1] if k + 1 < count else None)
            for name, rows in whole.items()
        }
        metadata = {**log.metadata, "part": f"{k + 1} of {count}: the times go back between them"}
        parts.append(Log(log.file, f"{log.name}-{k + 1}", tables, metadata))
    return parts


def _begins(table: LogTable) -> NDArray[np.int64]:
    """Rows at which a part of the table begins."""
    if table.time is None or not len(table.time):
        return np.zeros(1, int)
    return np.concatenate([[0], 1 + np.flatnonzero(np.diff(table.time) < -BACK)])


def _rows(table: LogTable, first: int, end: int | None) -> LogTable:
    """The rows from `first` up to `end`."""
    whole, chosen = table.table, slice(first, end)
    cut = replace(
        whole,
        columns={name: values[chosen] for name, values in whole.columns.items()},
        rows=whole.rows[chosen],
    )
    return replace(table, table=cut, time=None if table.time is None else table.time[chosen])
