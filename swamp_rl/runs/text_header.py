"""The first line of a table in text: what separates its cells, and the names of its columns."""

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

from swamp_rl.counted import counted
from swamp_rl.ordinary import ordinary

TEXTS = (".csv", ".tsv", ".txt", ".dat", ".log")
"""Suffixes of tables in text."""
SEPARATORS = ";", "\t"
"""Of cells, where a first line without a comma has them; numbers may then have a decimal comma."""
LONGEST_HEADER = 2**17
FIRST_LINES = 20
"""Of a text, in which a table's first row is looked for."""
BETWEEN = re.compile(r"[,;]\s*|\s+")
"""Cells of a row, whatever separates them."""
DOUBLED_END = b"\r\r\n"
"""What Python's csv writes on Windows to a file that was opened without newline=''; no empty line."""
COMMENT = re.compile(rb"(\xef\xbb\xbf)?[#%]+[ \t]*(?=\w)")
"""Before the names in files of NumPy, MATLAB or gnuplot."""


@dataclass(frozen=True)
class Header:
    """`names` of the columns, what separates cells, and the text itself, its columns so separated."""

    names: list[str]
    separator: str
    text: bytes


class HeaderError(ValueError):
    """What is wrong with a first line."""


def read_header(text: bytes) -> Header:
    """The header of a table in UTF-8, and the table without the mark of a comment before it, with plain line
    ends.

    Commas separate cells, or SEPARATORS, or spaces where the second line has as many words as the first;
    spaces become tabs. HeaderError where the first line names no columns.
    """
    text = text.replace(DOUBLED_END, b"\r\n")
    if mark := COMMENT.match(text):
        text = text[mark.end() :]
    with io.TextIOWrapper(io.BytesIO(text), encoding="utf-8-sig", newline="") as lines:
        head = lines.read(LONGEST_HEADER)
    try:
        names, separator = _cells(head)
    except csv.Error as error:
        raise HeaderError(f"its first line cannot be read ({error}); it must name the columns") from error
    if len(head) == LONGEST_HEADER and not set("\r\n") & set(head):
        raise HeaderError(f"its first line has more than {LONGEST_HEADER} letters; name fewer columns")
    if not any(names):
        raise HeaderError("starts with an empty line or none; the first line must name the columns")
    if separator == " ":
        whole = text.endswith((b"\n", b"\r"))
        text = b"\n".join(b"\t".join(line.split()) for line in text.splitlines()) + b"\n" * whole
        separator = "\t"
    if len(names) == 1 and (later := _first_row(head.splitlines()[1:])):
        number, values = later
        raise HeaderError(other_columns(1, number + 2, values))
    if _are_values(names):
        raise HeaderError("its first line holds numbers; the first line must name the columns, add one")
    return Header(names, separator, text)


def other_columns(names: int, number: int, values: int) -> str:
    """What is wrong with a first line that names not as many columns as line `number` has values."""
    return (
        f"its first line names {counted(names, 'column')}, line {number} has {values} values; the first line "
        "must name the columns, remove what stands before it"
    )


def _cells(head: str) -> tuple[list[str], str]:
    """The cells of the first line, and what separates them."""
    names = next(csv.reader(io.StringIO(head, newline="")), [])
    if len(names) != 1:
        return names, ","
    if other := next((one for one in SEPARATORS if one in names[0]), None):
        return next(csv.reader(io.StringIO(head, newline=""), delimiter=other)), other
    first, second = (line.split() for line in [*head.splitlines()[:2], "", ""][:2])
    return (first, " ") if len(first) == len(second) > 1 else (names, ",")


def _first_row(lines: list[str]) -> tuple[int, int] | None:
    """The index of the first line that holds several numbers, and how many; None where none does."""
    found = (
        (i, len(cells))
        for i, line in enumerate(lines)
        if len(cells := BETWEEN.split(line.strip())) > 1 and _are_values(cells)
    )
    return next(found, None)


def _are_values(names: list[str]) -> bool:
    """Whether all are numbers, and not all whole, as the default names of some programs are."""
    return None not in map(number_in, names) and not all(name.strip().isdigit() for name in names)


def number_in(cell: str | None) -> float | None:
    """The number that a cell holds, or None."""
    if cell is None or "_" in cell or not cell.isascii():
        return None
    try:
        return float(cell)
    except ValueError:
        return None


def unquoted(name: str) -> str:
    """A column's name without the spaces and quotation marks around it."""
    name = name.strip()
    return name[1:-1].strip() if len(name) > 1 and name[0] == name[-1] == '"' else name


def has_names(path: Path) -> bool:
    """Whether the first line of a file names the columns of a table: at least two words, none a number."""
    try:
        names = read_header(_begin(path, 2)).names
    except (HeaderError, UnicodeDecodeError):
        return False
    return len(names) > 1 and all(name.strip() and number_in(name) is None for name in names)


def complaint_of(path: Path) -> str | None:
    """What is wrong with the first line of a table in text; None where nothing is, or it is no text."""
    try:
        read_header(_begin(path, FIRST_LINES))
    except HeaderError as error:
        return str(error)
    except UnicodeDecodeError:
        pass
    return None


def _begin(path: Path, lines: int) -> bytes:
    with ordinary(path, None).open("rb") as stream:
        return b"".join(stream.readline(LONGEST_HEADER) for _ in range(lines))
