"""MATLAB's files (.mat), through scipy."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.logs.binary import LARGEST, reading
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS, Table

WHAT = "MATLAB file"
NUMBERS = frozenset(
    ("double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))
)


def read_matlab(path: Path) -> Log:
    """The vectors and matrices of the commonest length as a table, named after the file.

    A matrix `NAME` of several columns has columns `NAME[0]`, `NAME[1]`. A recorder that stops within a row
    leaves vectors that differ by one; the table ends with the shorter. UserError for a damaged file, one of
    version 7.3, and one without vectors.
    """
    with reading(path, WHAT):
        from scipy.io import loadmat, whosmat

        ordinary(path, LARGEST)
        try:
            held = whosmat(path)
            sizes = {key: shape for key, shape, kind in held if kind in NUMBERS and _is_column(shape)}
            if sum(int(np.prod(shape)) for shape in sizes.values()) > MOST_CELLS:
                raise UserError(f"{path}: has more than {MOST_CELLS} values; divide the log")
            values = loadmat(path, variable_names=list(sizes)) if sizes else {}
        except NotImplementedError as error:
            why = "is of MATLAB's version 7.3, which is not read; save it with save(NAME, '-v7')"
            raise UserError(f"{path}: {why}") from error
        except OSError as error:
            raise error if error.errno else EOFError(str(error)) from error  # scipy's, of a file cut off
    if not sizes:
        raise UserError(f"{path}: has no vectors of numbers; save each column of the log as a vector")
    columns = {key: _rows_first(np.asarray(values[key], float)) for key in sizes}
    rows = _rows(columns)
    kept = {key: own for key, own in columns.items() if len(own) in (rows, rows + 1)}
    table = Table(dict(list(_columns(kept, rows))[:MOST_COLUMNS]), np.arange(1, rows + 1))
    others = ", ".join(key for key, *_ in held if key not in kept)
    name = table_name(path.stem)
    told = {"not_read": f"{others} (of another length or type)"} if others else {}
    return Log(path.name, path.stem, {name: LogTable(name, table, kind="table", origin=path.name)}, told)


def _is_column(shape: tuple[int, ...]) -> bool:
    return len(shape) == 2 and max(shape) > 1 and min(shape) > 0


def _rows_first(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """A vector or matrix (T, k), of either orientation: a log has more rows than columns."""
    return values if values.shape[0] >= values.shape[1] else values.T


def _rows(columns: Mapping[str, NDArray[np.float64]]) -> int:
    """The commonest length, the longest of several; one less where a column is that much shorter."""
    counts = Counter(len(own) for own in columns.values())
    rows = max(counts, key=lambda length: (counts[length], length))
    return rows - 1 if counts[rows - 1] else rows


def _columns(kept: Mapping[str, Any], rows: int) -> Iterator[tuple[str, NDArray[np.float64]]]:
    for key, values in kept.items():
        for k, own in enumerate(values[:rows].T):
            yield (table_name(key) if values.shape[1] == 1 else f"{table_name(key)}[{k}]"), own
