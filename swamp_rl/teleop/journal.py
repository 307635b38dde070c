"""A run while it is driven: an append-only CSV, row by row on the disk, and what it is about."""

import json
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from swamp_rl.errors import UserError
from swamp_rl.files import flush, os_error, write_beside
from swamp_rl.json_text import parsed_json


class Journal:
    """`NAME.csv` with the rows so far and `NAME.json` with the run's description, in the folder `unfinished`.

    Rows are written and flushed by a thread of the journal's own, so that a slow disk does not halt a boat;
    `sync` waits for them and raises what went wrong, as UserError.
    """

    def __init__(self, folder: Path, name: str, columns: Sequence[str], about: Mapping[str, Any]) -> None:
        self.table, self.description = folder / f"{name}.csv", folder / f"{name}.json"
        self._file: TextIO | None = None
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix=f"journal-{name}")
        self._last: Future[None] = self._thread.submit(self._open, ",".join(columns), dict(about))

    def append(self, row: Sequence[float]) -> None:
        """Add a row, soon to be on the disk; what went wrong with an earlier one is raised now."""
        if self._last.done():
            self.sync()
        # Python's shortest decimals read back as the same bits.
        line = ",".join(repr(float(value)) for value in row)
        self._last = self._thread.submit(self._write, line)

    def describe(self, about: Mapping[str, Any]) -> None:
        """Replace the description."""
        self._last = self._thread.submit(write_description, self.description, dict(about))

    def sync(self) -> None:
        """Wait until all is on the disk; UserError if it cannot be."""
        try:
            self._last.result()
        except OSError as error:
            raise os_error(error, self.table) from error

    def close(self) -> None:
        """`sync`, and no more rows."""
        self._thread.shutdown()
        try:
            self.sync()
        finally:
            if self._file is not None:
                self._file.close()

    def remove(self) -> None:
        """Close it and forget the run."""
        with suppress(UserError):
            self.close()
        for path in (self.table, self.description):
            path.unlink(missing_ok=True)

    def _open(self, header: str, about: dict[str, Any]) -> None:
        write_description(self.description, about)
        # Never over an older file: that could be an unfinished run.
        self._file = self.table.open("x", encoding="ascii")
        self._write(header)
        flush(self.table.parent)

    def _write(self, line: str) -> None:
        assert self._file is not None
        self._file.write(line + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())


def write_description(path: Path, about: Mapping[str, Any]) -> None:
    """Put what a run is about on the disk, whole or not at all."""
    with write_beside(path) as part:
        part.write_text(json.dumps(about, allow_nan=False), encoding="utf-8")


def read_description(path: Path) -> dict[str, Any]:
    """What `write_description` wrote; nothing where that cannot be read."""
    try:
        about = parsed_json(path.read_bytes())
    except (OSError, ValueError):
        return {}
    return about if isinstance(about, dict) else {}


def cut_torn_row(table: Path) -> int:
    """Cut what follows the last line end of a table that was being written; the number of whole rows left."""
    text = table.read_bytes()
    whole = text[: text.rfind(b"\n") + 1]
    if len(whole) < len(text):
        with table.open("r+b") as file:
            file.truncate(len(whole))
            os.fsync(file.fileno())
    return max(whole.count(b"\n") - 1, 0)
