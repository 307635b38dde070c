"""Run tables on disk: CSV and Parquet, the same columns, float64 and equal to the bit."""

import errno
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.ordinary import contents
from swamp_rl.runs.faults import NO_NUMBER, Fault, faults_at
from swamp_rl.runs.text_header import TEXTS, HeaderError, number_in, other_columns, read_header, unquoted

DECIMAL_COMMA = r"^(\s*[-+]?\d*),(\d+(?:[eE][-+]?\d+)?\s*)$"
FORMATS = ("csv", "parquet")
LARGEST = 2**30
"""Bytes of a file."""
MOST_COLUMNS = 1_000
MOST_ODD_ROWS = 1_000
"""Rows of another length than the header's after which a file is read no further."""
MOST_CELLS = 4 * 10**7
"""Of a file: a number takes 8 bytes of memory, however few it has in the file."""
EMPTY = "is missing; fill it in or remove the row and those after it"
"""What is wrong with an empty cell."""
REMEDIES = {
    errno.EACCES: "change its permissions",
    errno.EFBIG: "divide it",
    errno.EINVAL: "put a file in its place",
    errno.EPERM: "change its permissions",
}
"""By the number of the operating system's refusal."""
TICKS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
"""In a second, by the unit of a column of times."""


@dataclass
class Table:
    """What a file holds, before anyone has asked whether it makes sense.

    `columns`: float64 arrays, NaN where a cell was no number; `rows`: the number in the file of each row;
    `unread`: masks of the cells that `faults` already names; `whole`: no row had to be left out; `words`: the
    cells of the columns in which no cell is a number.
    """

    columns: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    rows: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    unread: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    whole: bool = True
    words: dict[str, pa.ChunkedArray] = field(default_factory=dict)


def read_table(path: Path) -> Table:
    """The table in a text or Parquet file with whatever is wrong with its cells, which never raises."""
    suffix = path.suffix.lower()
    if suffix not in (*TEXTS, ".parquet"):
        return _unreadable(path, f"is no table; save it as one of {', '.join(FORMATS)}")
    try:
        # Arrow, where it opens the file itself, tells the operating system's refusals on lines of its own.
        held = contents(path, LARGEST)
        return _read_parquet(path, held) if suffix == ".parquet" else _read_text(path, held)
    except UnicodeDecodeError as error:
        return _unreadable(path, f"byte {error.start} is not UTF-8 text; save the file as UTF-8")
    except (pa.ArrowException, OSError, IndexError) as error:
        if "UTF8" in str(error):
            return _unreadable(path, "holds text that is not UTF-8; save the file as UTF-8")
        if isinstance(error, OSError) and error.errno is not None:  # of the operating system, not of Arrow
            remedy = REMEDIES.get(error.errno, "copy it again")
            return _unreadable(path, f"cannot be read ({error.strerror}); {remedy}")
        reason = clipped(" ".join(str(error).split()), 300)
        return _unreadable(path, f"cannot be read and may be cut short ({reason}); copy it again")


def _unreadable(path: Path, message: str) -> Table:
    return Table(faults=[Fault(path.name, None, None, message)], whole=False)


def _read_parquet(path: Path, held: bytes) -> Table:
    file = pa.parquet.ParquetFile(pa.BufferReader(held), page_checksum_verification=True)
    if file.metadata.num_columns > MOST_COLUMNS:
        return _unreadable(
            path, f"has {file.metadata.num_columns} columns, at most {MOST_COLUMNS}; leave some out"
        )
    if file.metadata.num_rows * file.metadata.num_columns > MOST_CELLS:
        return _unreadable(path, f"declares {file.metadata.num_rows} rows; divide it into runs")
    odd = [one for one in file.schema_arrow if pa.types.is_nested(one.type)]
    if odd:
        kind = clipped(odd[0].type)
        return _unreadable(path, f"column {clipped(odd[0].name)} holds {kind}; leave it out")
    chunks = (file.metadata.row_group(group) for group in range(file.metadata.num_row_groups))
    if sum(chunk.total_byte_size for chunk in chunks) > LARGEST:
        return _unreadable(path, f"is larger than {LARGEST / 2**30:g} GiB unpacked; divide it into runs")
    # A text that many rows share would otherwise be there once for each.
    texts = [one.name for one in file.schema_arrow if not _numeric(one.type)]
    source = pa.BufferReader(held)
    data = pa.parquet.read_table(source, read_dictionary=texts, page_checksum_verification=True)
    return _numbers(path.name, data, np.arange(1, data.num_rows + 1), [])


def _read_text(path: Path, held: bytes) -> Table:
    try:
        header = read_header(held)
    except HeaderError as error:
        return _unreadable(path, str(error))
    names, held = header.names, header.text
    if len(names) > MOST_COLUMNS:
        return _unreadable(path, f"has {len(names)} columns, at most {MOST_COLUMNS}; leave some out")
    rows = max(held.count(b"\n"), held.count(b"\r"))
    if rows * len(names) > MOST_CELLS:
        return _unreadable(
            path, f"has {rows} rows of {len(names)} columns, at most {MOST_CELLS} cells; divide it into runs"
        )
    odd_rows: list[pa.csv.InvalidRow] = []

    def keep_note(row: pa.csv.InvalidRow) -> str:
        odd_rows.append(row)
        return "skip" if len(odd_rows) < MOST_ODD_ROWS else "error"

    try:
        data = pa.csv.read_csv(
            pa.BufferReader(held),
            pa.csv.ReadOptions(use_threads=False),
            pa.csv.ParseOptions(
                delimiter=header.separator, ignore_empty_lines=False, invalid_row_handler=keep_note
            ),
            pa.csv.ConvertOptions(column_types=dict.fromkeys(names, pa.string()), strings_can_be_null=False),
        )
    except pa.ArrowInvalid:
        if len(odd_rows) < MOST_ODD_ROWS:
            raise
        return _unreadable(path, _odd_header(odd_rows[0]))
    if len(odd_rows) > data.num_rows:
        return _unreadable(path, _odd_header(odd_rows[0]))
    data = data.rename_columns([unquoted(name) for name in data.column_names])
    if header.separator != ",":
        data = _with_points(data)
    # Arrow counts lines from 1 with the header as the first.
    odd = {row.number - 1: row for row in odd_rows}
    numbers = np.array([n for n in range(1, data.num_rows + len(odd) + 1) if n not in odd], np.int64)
    faults = [Fault(path.name, number, None, _odd_row(row)) for number, row in odd.items()]
    if not held.endswith((b"\n", b"\r")):
        last = data.num_rows + len(odd)
        message = "the file does not end with a line end, it may be cut short; compare it with its source"
        faults.append(Fault(path.name, last or None, None, message))
    return _numbers(path.name, data, numbers, faults)


def _with_points(data: pa.Table) -> pa.Table:
    """The table with a decimal point where numbers have a decimal comma."""
    points = [pc.replace_substring_regex(cells, DECIMAL_COMMA, r"\1.\2") for cells in data.columns]
    return pa.Table.from_arrays(points, names=data.column_names)


def _odd_header(row: pa.csv.InvalidRow) -> str:
    return other_columns(row.expected_columns, row.number, row.actual_columns)


def _odd_row(row: pa.csv.InvalidRow) -> str:
    return f"has {row.actual_columns} values for {row.expected_columns} columns; complete or remove the row"


def _numbers(file: str, data: pa.Table, rows: NDArray[np.int64], faults: list[Fault]) -> Table:
    table = Table(rows=rows, faults=faults, whole=len(rows) == 0 or rows[-1] == len(rows))
    for name, cells in zip(data.column_names, data.columns, strict=True):
        if name in table.columns or not name.strip():
            what = "is named twice" if name.strip() else "has no name"
            table.faults.append(Fault(file, None, name or "''", f"{what}; give each column its own name"))
            continue
        if pa.types.is_dictionary(cells.type) and not is_text(cells.type):
            cells = cells.cast(cells.type.value_type)
        values, unread = _floats(cells)
        table.columns[name], table.unread[name] = values, unread
        if unread.size and unread.all():
            table.words[name] = cells
        if unread.size and _is_empty(cells):
            table.faults.append(Fault(file, None, name, NO_NUMBER))
        else:
            table.faults += faults_at(file, name, rows, unread, partial(_no_number, cells))
    return table


def _no_number(cells: pa.ChunkedArray, index: int) -> str:
    cell = cell_text(cells, index)
    if not cell:
        return EMPTY
    hint = " (use a point, not a comma)" if "," in cell else ""
    if hint and "." in cell:
        hint = " (leave out what separates thousands)"
    return f"{cell[:40]!r} is not a number; correct it{hint}"


def cell_text(cells: pa.ChunkedArray, index: int) -> str:
    """A cell as text, empty for none; a time in UTC."""
    cell = cells.slice(index, 1)
    if pa.types.is_timestamp(cell.type):
        cell = cell.cast(pa.timestamp(cell.type.unit))  # without the zone, which may be unknown
    if pa.types.is_temporal(cell.type):
        cell = cell.cast(pa.string())  # Python has no nanoseconds and no year 10000
    value = cell[0].as_py()
    return "" if value is None else str(value)


def _is_empty(cells: pa.ChunkedArray) -> bool:
    return cells.null_count == len(cells) or (is_text(cells.type) and not any(cells.unique().to_pylist()))


def _floats(cells: pa.ChunkedArray) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Cells as float64, whole numbers rounded, durations in seconds; and which of them are no number."""
    if pa.types.is_duration(cells.type):
        ticks = pc.cast(pc.cast(cells, pa.int64()), pa.float64(), safe=False)
        values = pc.divide(ticks, float(TICKS[cells.type.unit]))
    elif _numeric(cells.type):
        values = pc.cast(cells, pa.float64(), safe=False)
    elif is_text(cells.type):
        return _of_texts(cells)
    else:
        return np.full(len(cells), np.nan), np.ones(len(cells), bool)
    return np.array(pc.fill_null(values, np.nan), np.float64), np.asarray(pc.is_null(values), bool)


def _of_texts(cells: pa.ChunkedArray) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """As `_floats`, of texts."""
    if pa.types.is_dictionary(cells.type):
        return _each_once(cells)
    cells = pc.utf8_trim_whitespace(cells)
    try:
        values = pc.cast(cells, pa.float64())
    except pa.ArrowInvalid:
        return _each_once(cells.dictionary_encode())
    return np.array(pc.fill_null(values, np.nan), np.float64), np.asarray(pc.is_null(values), bool)


def _each_once(cells: pa.ChunkedArray) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """As `_floats`, text by text, each that comes again looked at once."""
    cells = cells.unify_dictionaries()
    if cells.num_chunks == 0:
        return np.zeros(0), np.zeros(0, bool)
    known = [number_in(cell) for cell in cells.chunk(0).dictionary.to_pylist()]
    numbers = np.array([np.nan if number is None else number for number in [*known, None]])
    unread = np.array([number is None for number in [*known, None]])
    places = [pc.fill_null(chunk.indices, len(known)) for chunk in cells.chunks]
    at = np.concatenate([np.asarray(place, np.int64) for place in places])
    return numbers[at], unread[at]


def _numeric(kind: pa.DataType) -> bool:
    return pa.types.is_integer(kind) or pa.types.is_floating(kind)


def is_text(kind: pa.DataType) -> bool:
    """Whether cells of a type are texts, each written out or looked up."""
    kind = kind.value_type if pa.types.is_dictionary(kind) else kind
    return pa.types.is_string(kind) or pa.types.is_large_string(kind)


def write_table(path: Path, columns: dict[str, NDArray[np.float64]]) -> None:
    """Write columns of equal length to a .csv or .parquet file, beside it first and then renamed."""
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise UserError(f"{path}: a run is written as .csv or .parquet; change the suffix")
    data = pa.table({name: pa.array(np.ascontiguousarray(values)) for name, values in columns.items()})
    with write_beside(path) as part:
        if kind == "parquet":
            pa.parquet.write_table(data, part, write_page_checksum=True)
            return
        with part.open("wb") as lines:
            lines.write(_header(data.column_names))
            pa.csv.write_csv(data, lines, pa.csv.WriteOptions(include_header=False))


def _header(names: list[str]) -> bytes:
    # Arrow would put every name in quotes.
    quoted = ['"' + name.replace('"', '""') + '"' if set(name) & set(',"\r\n') else name for name in names]
    return (",".join(quoted) + "\n").encode()
