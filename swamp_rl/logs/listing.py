"""What a log holds, for who writes a mapping: its tables, rates and fields."""

from collections.abc import Hashable, Iterator

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.counted import counted
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.runs.stamps import from_words
from swamp_rl.runs.table import cell_text

MOST_FIELDS = 200


def listing(log: Log) -> Iterator[str]:
    """Lines: of each table its name, type, rate and number of messages, then a line for each field with its
    span and number of values."""
    for table in log.tables.values():
        rate = f", {table.rate:.3g} Hz" if table.rate else ""
        origin = f" ({clipped(table.origin)})" if table.origin not in ("", table.name) else ""
        kind = f", {clipped(table.kind)}" if table.kind else ""
        yield f"{clipped(table.name)}{origin}{kind}: {counted(len(table.table.rows), 'row')}{rate}"
        for name, values in list(table.table.columns.items())[:MOST_FIELDS]:
            yield f"  {_named(log, table, name)}: {_span(table, name, values)}"
    if "not_read" in log.metadata:
        yield f"not read: {clipped(log.metadata['not_read'], 400)}"


def fields_of(log: Log) -> Hashable:
    """Equal for logs of the same tables and fields; a lone table may have any name, such as the file's."""
    named = len(log.tables) > 1
    return tuple(
        (table.name if named else "", table.kind, *table.table.columns) for table in log.tables.values()
    )


def _named(log: Log, table: LogTable, column: str) -> str:
    return clipped(column if len(log.tables) == 1 else f"{table.name}.{column}")


def _span(table: LogTable, name: str, values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    if name in table.table.words or not len(known):
        words = table.table.words.get(name)
        if words is None or not len(words):
            return "no numbers"
        kind = "no numbers" if from_words(words) is None else "times"
        return f"{kind}, as {clipped(cell_text(words, 0), 40)!r}"
    lost = f", {len(values) - len(known)} missing" if len(known) < len(values) else ""
    return f"{known.min():.9g} to {known.max():.9g}, {counted(len(np.unique(known)), 'distinct value')}{lost}"
