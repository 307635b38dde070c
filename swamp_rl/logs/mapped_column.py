"""What a mapped column is made of: the tables and columns of a log that its expression reads."""

from collections.abc import Mapping as Mapped
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.logs.expression import Name, Node, evaluated, names_in
from swamp_rl.logs.frames import column_of
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapping import Mapping
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.resample import is_held
from swamp_rl.runs.stamps import Stamps
from swamp_rl.runs.units import factor

Array = NDArray[np.float64]
MOST_NAMED = 12
"""Tables or columns in a message."""


@dataclass(frozen=True)
class Column:
    """A mapped column: its expression, the table that it reads, and the names of that table's columns."""

    node: Node
    table: str
    names: Mapped[str, str]


@dataclass(frozen=True)
class Mixture:
    """A command of several tables: its expression, and by the names in it those of the columns that
    `columns_of` gives for them."""

    node: Node
    parts: Mapped[str, str]


def columns_of(log: Log, nodes: Mapped[str, Node]) -> tuple[dict[str, Column], dict[str, Mixture]]:
    """The columns that expressions read, and the commands that are mixed from those of several tables.

    Each column that a mixture reads is one of the first, named `COMMAND (NAME)`, and held between rows as a
    command is. UserError for another quantity of several tables: how its parts are to be interpolated is
    not known.
    """
    found: dict[str, Column] = {}
    mixed: dict[str, Mixture] = {}
    for name, node in nodes.items():
        where = f"--map {name}"
        if not is_held(name) or len(_tables_of(log, where, node)) < 2:
            found[name] = resolved(log, where, node)
            continue
        parts = {word: f"{name} ({word})" for word in dict.fromkeys(names_in(node))}
        found |= {part: resolved(log, where, Name(word)) for word, part in parts.items()}
        mixed[name] = Mixture(node, parts)
    return found, mixed


def with_mixtures(
    columns: Mapped[str, Array], mixed: Mapped[str, Mixture], mapping: Mapping
) -> dict[str, Array]:
    """Joined columns (T,) with the mixtures in place of the columns that they are made of, in our units."""
    parts = {part for one in mixed.values() for part in one.parts.values()}
    made = {name: values for name, values in columns.items() if name not in parts}
    for name, one in mixed.items():
        there = {word: columns[part] for word, part in one.parts.items()}
        made[name] = _in_our_unit(evaluated(one.node, there, columns["time"]), name, mapping)
    return made


def of_mixtures(faults: Sequence[Fault], mixed: Mapped[str, Mixture]) -> list[Fault]:
    """The faults, those of a column that is mixed as faults of the command."""
    commands = {part: name for name, one in mixed.items() for part in one.parts.values()}
    return [replace(one, column=commands.get(str(one.column), one.column)) for one in faults]


def resolved(log: Log, where: str, node: Node) -> Column:
    """The one table that an expression reads, and its columns by the names in the expression."""
    tables = _tables_of(log, where, node)
    if len(tables) > 1:
        raise UserError(
            f"{log.file}: {where}: reads the tables {' and '.join(tables)}, whose rows have times of their "
            "own; map each to a column of its own, then import that dataset with this expression of its "
            "columns"
        )
    return Column(node, *next(iter(tables.items()), ("", {})))


def _tables_of(log: Log, where: str, node: Node) -> dict[str, dict[str, str]]:
    """The columns that an expression reads, by their names in it, of each table."""
    tables: dict[str, dict[str, str]] = {}
    for word in dict.fromkeys(names_in(node)):
        table, column = find(log, where, word)
        tables.setdefault(table, {})[word] = column
    return tables


def find(log: Log, where: str, word: str) -> tuple[str, str]:
    """The table and the column that a name means: TABLE.COLUMN, or a column of the only table."""
    if len(log.tables) == 1:
        table = next(iter(log.tables.values()))
        if word in table.table.columns:
            return table.name, word
    name, _, column = word.partition(".")
    if name in log.tables and column in log.tables[name].table.columns:
        return name, column
    if name in log.tables:
        known = list(log.tables[name].table.columns)
        what = f"{name} has no field {clipped(column)!r}" if column else f"{name} is a table; name its field"
    elif len(log.tables) == 1:
        known = list(next(iter(log.tables.values())).table.columns)
        what = f"there is no column {clipped(word)!r}"
    else:
        known, what = list(log.tables), f"there is no table {clipped(name)!r}"
    some = known if len(known) <= MOST_NAMED else sorted(known, key=lambda other: other[:1] != word[:1])
    raise UserError(f"{log.file}: {where}: {what}{nearest(column or word, some[:60])}"[:1500])


def values_of(log: Log, mapping: Mapping, name: str, column: Column, stamps: Stamps) -> Array:
    """A mapped column (T,) at the times of its table, in our unit."""
    return _in_our_unit(_evaluated(column, _columns_read(log, column), stamps), name, mapping)


def added_by(log: Log, mapping: Mapping, name: str, column: Column, stamps: Stamps) -> Array:
    """The size (T,) of what an expression adds to one of its columns, in our unit: 4 of `compass + 4`.

    The least of the sizes with one of its columns 0, so that of `compass + variation` it is the variation.
    """
    there = _columns_read(log, column)
    without = [_evaluated(column, there | {word: np.zeros_like(there[word])}, stamps) for word in there]
    sizes = [np.nan_to_num(np.abs(values)) for values in without] or [np.zeros(stamps.time.shape)]
    return _in_our_unit(np.minimum.reduce(sizes), name, mapping)


def _columns_read(log: Log, column: Column) -> dict[str, Array]:
    """The columns of the log by their names in the expression."""
    return {word: log.tables[column.table].table.columns[theirs] for word, theirs in column.names.items()}


def _evaluated(column: Column, there: Mapped[str, Array], stamps: Stamps) -> Array:
    return np.array(np.broadcast_to(evaluated(column.node, there, stamps.time), stamps.time.shape))


def _in_our_unit(values: Array, name: str, mapping: Mapping) -> Array:
    unit = mapping.units.get(name)
    return values if unit is None else values * factor(name, unit, column_of(name, mapping))
