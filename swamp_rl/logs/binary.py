"""What the readers of binary logs share: limits, damage as one line, tables from rows."""

import math
import os
import sys
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.extras import missing
from swamp_rl.files import os_error
from swamp_rl.logs.log import LogTable
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS, Table

LARGEST = 2**32
"""Bytes of a log."""


@contextmanager
def reading(path: Path, what: str, repair: str = "") -> Iterator[None]:
    """Whatever a reader of damaged bytes raises or prints, as one line; repair: the command that mends a file
    whose end is missing."""
    try:
        # Not into memory: some complain of every byte.
        with open(os.devnull, "w") as sink, redirect_stdout(sink), redirect_stderr(sink):
            yield
    except UserError:
        raise
    except ImportError as error:
        raise missing(f"{path}: {what} needs {error.name}", "logs") from error
    except OSError as error:
        raise os_error(error, path) from error
    except (Exception, RecursionError) as error:
        reason = f" ({clipped(words, 200)})" if (words := _words(error)) else ""
        remedy = f"copy it again{repair and f', or repair it with {repair}'}"
        raise UserError(f"{path}: is not a complete {what}{reason}; {remedy}") from error


def _words(error: BaseException) -> str:
    """What a reader says of a file; empty for an error of Python, alone or behind a reader's, which tells of
    the reader's code."""
    of_python = type(error).__module__.partition(".")[0] in sys.stdlib_module_names
    own = type(error) is ValueError or not (of_python or error.__context__)
    return str(error).rstrip(".") if own else ""


def refuse_other_bytes(path: Path, what: str, begin: bytes) -> None:
    """UserError for a file that does not begin as all of its kind do."""
    with path.open("rb") as file:
        if file.read(len(begin)) != begin:
            raise UserError(f"{path}: is no {what}, it does not begin as one; check its name, or give --from")


class Gathered:
    """Rows of named numbers of one table as they come, no more than MOST_COLUMNS and MOST_CELLS."""

    def __init__(self, path: Path, name: str, kind: str, origin: str, clocks: Collection[str]) -> None:
        self.path, self.name, self.kind, self.origin, self.clocks = path, name, kind, origin, clocks
        self.stamps: list[float] = []
        self.columns: dict[str, list[float]] = {}

    def add(self, stamp: float, fields: Mapping[str, Any]) -> None:
        """A row at `stamp` [s]; a field that is not there, or no number, is NaN."""
        new = [name for name in fields if name not in self.columns][: MOST_COLUMNS - len(self.columns)]
        if (len(self.stamps) + 1) * max(len(self.columns) + len(new), 1) > MOST_CELLS:
            raise UserError(f"{self.path}: {self.name} has more than {MOST_CELLS} values; divide the log")
        self.columns |= {name: [math.nan] * len(self.stamps) for name in new}
        self.stamps.append(stamp)
        for name, values in self.columns.items():
            values.append(number(fields.get(name)))

    def table(self) -> LogTable:
        """The rows as arrays."""
        columns = {name: np.array(values, float) for name, values in self.columns.items()}
        rows = np.arange(1, len(self.stamps) + 1)
        stamps = np.array(self.stamps, float)
        return LogTable(self.name, Table(columns, rows), stamps, self.kind, self.origin, self.clocks)


def number(value: Any) -> float:
    """A finite number, else NaN."""
    if isinstance(value, bool | int | float | np.number | np.bool_):
        try:
            return float(value)
        except (OverflowError, ValueError):
            return float("nan")
    return float("nan")
