"""A run while it is driven: an append-only CSV, row by row on the disk, and what it is about."""

import errno
import json
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from swamp_rl.errors import UserError
from swamp_rl.files import flush, os_error, write_beside
from swamp_rl.json_text import parsed_json
from swamp_rl.ordinary import MOST_JSON, contents


class Journal:
    """`NAME.csv` with the rows so far and `NAME.json` with the run's description, in the folder `unfinished`.

    Rows are written and flushed by a thread of the journal's own, so that a slow disk does not halt a boat.
    They are kept in memory too: after the first call that the disk refuses nothing more is written, `trouble`
    says why, and `close` writes the whole table once more.
    """

    def __init__(self, folder: Path, name: str, columns: Sequence[str], about: Mapping[str, Any]) -> None:
        self.table, self.description = folder / f"{name}.csv", folder / f"{name}.json"
        self.trouble: UserError | None = None
        self._lines = [",".join(columns)]
        self._file: TextIO | None = None
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix=f"journal-{name}")
        self._do(self._open, dict(about))

    def append(self, row: Sequence[float]) -> None:
        """Add a row, soon to be on the disk."""
        # Python's shortest decimals read back as the same bits.
        line = ",".join(repr(float(value)) for value in row)
        self._lines.append(line)
        self._do(self._write, line)

    def describe(self, about: Mapping[str, Any]) -> None:
        """Replace the description."""
        self._do(write_description, self.description, dict(about))

    def sync(self) -> None:
        """Wait until all is on the disk; UserError if it is not."""
        self._last.result()
        if self.trouble is not None:
            raise self.trouble

    def close(self) -> None:
        """Have all rows on the disk, and take no more; UserError if it refuses: it may be tried again."""
        self._let_go()
        if self.trouble is None and self.table.exists():
            return
        _need(self.table.parent)
        with write_beside(self.table) as part:
            part.write_text("\n".join(self._lines) + "\n", encoding="ascii")
        self.trouble = None

    def remove(self) -> None:
        """Close it and forget the run; what cannot be deleted is `interrupted` at the next start."""
        self._let_go()
        for path in (self.table, self.description):
            with suppress(OSError):
                path.unlink()

    def _let_go(self) -> None:
        self._thread.shutdown()
        if self._file is not None:
            with suppress(OSError):  # each row was flushed, so nothing is left to be written
                self._file.close()

    def _do(self, work: Callable[..., None], *words: Any) -> None:
        self._last: Future[None] = self._thread.submit(self._tried, work, *words)

    def _tried(self, work: Callable[..., None], *words: Any) -> None:
        if self.trouble is not None:
            return
        try:
            work(*words)
        except UserError as error:
            self.trouble = error
        except OSError as error:
            self.trouble = os_error(error, self.table)

    def _open(self, about: dict[str, Any]) -> None:
        write_description(self.description, about)
        # Never over an older file: that could be an unfinished run.
        self._file = self.table.open("x", encoding="ascii")
        self._write(self._lines[0])
        flush(self.table.parent)

    def _write(self, line: str) -> None:
        assert self._file is not None  # opened by the first work, after whose failure there is no other
        self._file.write(line + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())


def write_description(path: Path, about: Mapping[str, Any]) -> None:
    """Put what a run is about on the disk, whole or not at all, into a folder that is there."""
    _need(path.parent)
    with write_beside(path) as part:
        part.write_text(json.dumps(about, allow_nan=False), encoding="utf-8")


def _need(folder: Path) -> None:
    """UserError where a folder is gone: half a dataset in its place would hide the whole one's return."""
    if not folder.is_dir():
        raise os_error(FileNotFoundError(errno.ENOENT, "the folder is gone"), folder)


def read_description(path: Path) -> dict[str, Any]:
    """What `write_description` wrote; nothing where that cannot be read."""
    try:
        about = parsed_json(contents(path, MOST_JSON))
    except (OSError, ValueError):
        return {}
    return about if isinstance(about, dict) else {}


def cut_torn_rows(table: Path) -> int:
    """Cut the end of a table that was being written: what follows the last line end, and from the first row
    that holds a NUL, which a power cut leaves in place of bytes not yet on the disk. The number of rows left.
    """
    text = contents(table)
    sound = text.partition(b"\0")[0]
    whole = sound[: sound.rfind(b"\n") + 1]
    if len(whole) < len(text):
        with write_beside(table) as part:  # never into a file that may have another name elsewhere
            part.write_bytes(whole)
    return max(whole.count(b"\n") - 1, 0)
