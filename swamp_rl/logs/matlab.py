"""MATLAB's files (.mat) as tables."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.logs.binary import reading
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.mat_file import variables
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import contents
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS, Table

OTHER_VERSION = "is not of MATLAB's versions 5 to 7 (version 7.3 is not read); save it with save(NAME, '-v7')"
Column = NDArray[np.float64]


def read_matlab(path: Path) -> Log:
    """The vectors and matrices of the commonest length as a table, named after the file.

    A matrix `NAME` of several columns has columns `NAME[0]`, `NAME[1]`. A recorder that stops within a row
    leaves vectors that differ by one; the table ends with the shorter. UserError for a damaged file, one of
    another version, and one without vectors.
    """
    with reading(path, "MATLAB file"):
        try:
            held = [one for one in variables(contents(path), MOST_CELLS) if one.name]
        except NotImplementedError as error:
            raise UserError(f"{path}: {OTHER_VERSION}") from error
    columns = {one.name: _rows_first(one.values) for one in held if one.values is not None}
    columns = {name: own for name, own in columns.items() if len(own) > 1 and own.size}
    if not columns:
        raise UserError(f"{path}: has no vectors of numbers; save each column of the log as a vector")
    rows = _rows(columns)
    kept = {name: own for name, own in columns.items() if len(own) in (rows, rows + 1)}
    table = Table(dict(list(_columns(kept, rows))[:MOST_COLUMNS]), np.arange(1, rows + 1))
    others = ", ".join(clipped(one.name) for one in held if one.name not in kept)
    name = table_name(path.stem)
    metadata = {"not_read": f"{others} (of another length or type)"} if others else {}
    return Log(path.name, path.stem, {name: LogTable(name, table, kind="table", origin=path.name)}, metadata)


def _rows_first(values: Column) -> Column:
    """A vector or matrix (T, k), of either orientation: a log has more rows than columns."""
    return values if values.shape[0] >= values.shape[1] else values.T


def _rows(columns: Mapping[str, Column]) -> int:
    """The commonest length, the longest of several; one less where a column is that much shorter."""
    counts = Counter(len(own) for own in columns.values())
    rows = max(counts, key=lambda length: (counts[length], length))
    return rows - 1 if counts[rows - 1] else rows


def _columns(kept: Mapping[str, Any], rows: int) -> Iterator[tuple[str, Column]]:
    for key, values in kept.items():
        for k, own in enumerate(values[:rows].T):
            yield (table_name(key) if values.shape[1] == 1 else f"{table_name(key)}[{k}]"), own
