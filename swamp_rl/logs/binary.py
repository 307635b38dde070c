"""What the readers of binary logs share: limits, damage as one line, tables from rows."""

import os
from collections.abc import Iterator, Sequence
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
        said = clipped(str(error).rstrip(".") or type(error).__name__, 200)
        remedy = f"copy it again{repair and f', or repair it with {repair}'}"
        raise UserError(f"{path}: is no complete {what} ({said}); {remedy}") from error


def refuse_other_bytes(path: Path, what: str, begin: bytes) -> None:
    """UserError for a file that does not begin as all of its kind do."""
    with path.open("rb") as file:
        if file.read(len(begin)) != begin:
            raise UserError(f"{path}: is no {what}, it does not begin as one; check its name, or give --from")


class Gathered:
    """Rows of named numbers of one table as they come, no more than MOST_CELLS."""

    def __init__(self, path: Path, name: str, kind: str, origin: str, names: Sequence[str]) -> None:
        self.path, self.name, self.kind, self.origin = path, name, kind, origin
        self.names = list(names)[:MOST_COLUMNS]
        self.stamps: list[float] = []
        self.rows: list[list[float]] = []

    def add(self, stamp: float, values: Sequence[Any]) -> None:
        """A row at `stamp` [s]; what is no number is NaN."""
        if (len(self.rows) + 1) * max(len(self.names), 1) > MOST_CELLS:
            raise UserError(f"{self.path}: {self.name} has more than {MOST_CELLS} values; divide the log")
        self.stamps.append(stamp)
        self.rows.append([number(value) for value in values[: len(self.names)]])

    def table(self) -> LogTable:
        """The rows as arrays."""
        values = np.array(self.rows, float).reshape(len(self.rows), len(self.names)).T
        columns = dict(zip(self.names, values, strict=True))
        rows = np.arange(1, len(self.rows) + 1)
        return LogTable(self.name, Table(columns, rows), np.array(self.stamps, float), self.kind, self.origin)


def number(value: Any) -> float:
    """A finite number, else NaN."""
    if isinstance(value, bool | int | float | np.number | np.bool_):
        try:
            return float(value)
        except (OverflowError, ValueError):
            return float("nan")
    return float("nan")
