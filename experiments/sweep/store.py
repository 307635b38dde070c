"""The trials of a sweep that have ended, in an SQLite file: a killed sweep has lost none of them."""

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.json_text import parsed_json
from swamp_rl.ordinary import ordinary
from swamp_rl.seal import BLANK, KEY, refuse_changed, sealed
from swamp_rl.sqlite_file import refuse_endless

FILE = "trials.sqlite"
AGAIN = "remove the file to start again, or name another folder with --out"
TABLES = {
    "trials": "CREATE TABLE trials (number INTEGER PRIMARY KEY, trial TEXT)",
    "plan": "CREATE TABLE plan (plan TEXT)",
}
HINTS = {
    sqlite3.SQLITE_BUSY: "is another sweep at work there? wait for it, or name --out",
    sqlite3.SQLITE_FULL: "free some room",
}
"""By the primary code of an error of SQLite (https://sqlite.org/rescode.html)."""
LONGEST_TOLD = 60
"Characters of a setting in a message."
LONGEST = 2**24
"Bytes of a row."
END = bytes.fromhex("d9d505f920a163d7")
"""Of a journal that names another file, which SQLite deletes after it has rolled the journal back
(https://sqlite.org/fileformat2.html#the_rollback_journal and `pager_delsuper` of its source)."""


@dataclass(frozen=True)
class Trial:
    """One that has ended, well or not.

    number: from 0; value: of the objective, None where it failed or had none; summary: of its episodes;
    error: the last line of a failed one; attempts and seconds: what it took, which another run of the same
    sweep need not repeat.
    """

    number: int
    values: dict[str, Any]
    value: float | None
    summary: dict[str, Any] | None
    error: str | None
    attempts: int
    seconds: float

    @property
    def counted(self) -> int:
        """The number as it is reported, from 1."""
        return self.number + 1


class Store:
    """Ended trials by number; each is on the disk before `add` returns."""

    def __init__(self, connection: sqlite3.Connection, path: Path) -> None:
        self._connection, self._path = connection, path

    def trials(self) -> dict[int, Trial]:
        """All that have ended; UserError where a row has changed since it was written."""
        rows = self._connection.execute("SELECT number, trial FROM trials ORDER BY number")
        return {number: self._trial(number, row) for number, row in rows}

    def _trial(self, number: Any, row: Any) -> Trial:
        where = f"{self._path}: row {number}"
        try:
            refuse_changed(where, row.encode(), AGAIN)
            stored = parsed_json(row)
            del stored[KEY]
            trial = Trial(**stored)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise UserError(f"{where}: is not a trial ({error}); {AGAIN}") from error
        if trial.number != number:
            raise UserError(f"{where}: is in the place of row {trial.number}; {AGAIN}")
        return trial

    def add(self, trial: Trial) -> None:
        """Keep one for good."""
        with self._connection:
            self._connection.execute("INSERT INTO trials VALUES (?, ?)", _row(trial))

    def replace(self, trials: Iterable[Trial]) -> None:
        """Keep these in place of all others."""
        with self._connection:
            self._connection.execute("DELETE FROM trials")
            self._connection.executemany("INSERT INTO trials VALUES (?, ?)", map(_row, trials))


def _row(trial: Trial) -> tuple[int, str]:
    text = json.dumps({**asdict(trial), KEY: BLANK}, allow_nan=False)
    return trial.number, sealed(text.encode()).decode()


@contextmanager
def opened(folder: Path, plan: dict[str, Any]) -> Iterator[Store]:
    """The store in `folder`, made where there is none; for this process alone until the block ends.

    plan: all that the results depend on. UserError where the folder holds trials of another plan or something
    else, or another process is at work on it.
    """
    path = folder / FILE
    connection = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not path.exists() and any(folder.iterdir()):
            raise UserError(
                f"{folder}: already exists and is no earlier sweep; name another folder with --out"
            )
        _refuse_foreign(path)
        connection = sqlite3.connect(path, timeout=0.5)
        connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LONGEST)
        refuse_endless(connection)
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("PRAGMA synchronous = FULL")
        _agree(connection, path, json.dumps(plan, sort_keys=True))
        yield Store(connection, path)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}; name another folder with --out") from error
    except sqlite3.OperationalError as error:
        hint = HINTS.get(_code(error), "check its permissions, or name another folder with --out")
        raise UserError(f"{path}: {error}; {hint}") from error
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: {error}; name another folder with --out, or remove it") from error
    finally:
        if connection is not None:
            _unlock(connection)
            connection.close()


def _code(error: sqlite3.Error) -> int:
    """The primary code of an error of SQLite, 0 of one of Python's module: a text that is not UTF-8."""
    return getattr(error, "sqlite_errorcode", 0) & 0xFF


def _unlock(connection: sqlite3.Connection) -> None:
    """Have SQLite remove its journal and let others in (https://sqlite.org/pragma.html#pragma_locking_mode).

    Closed while it alone may use the file, it writes the journal to the disk first, of which nothing is
    needed any more, and leaves it there where the disk refuses.
    """
    with suppress(sqlite3.Error, UnicodeDecodeError):
        connection.execute("PRAGMA locking_mode = NORMAL")
        # Of SQLite's own table: one of a stranger's may be a view without end.
        connection.execute("SELECT 1 FROM sqlite_schema LIMIT 1").fetchone()


def _refuse_foreign(path: Path) -> None:
    """UserError for a link, which leads to a file elsewhere, and for a journal that names one."""
    journal = path.with_name(f"{path.name}-journal")
    for one in (path, journal, path.with_name(f"{path.name}-wal"), path.with_name(f"{path.name}-shm")):
        if one.is_symlink():
            raise UserError(f"{one}: is a link; {AGAIN}")
    if path.exists():
        ordinary(path)
    if journal.exists():
        with ordinary(journal).open("rb") as file:
            file.seek(max(journal.stat().st_size - len(END), 0))
            if file.read() == END:
                raise UserError(f"{journal}: names a file elsewhere, which no sweep does; remove it")


def _agree(connection: sqlite3.Connection, path: Path, plan: str) -> None:
    with connection:
        connection.execute("BEGIN EXCLUSIVE")
        found = connection.execute(
            "SELECT name, sql FROM sqlite_schema LIMIT ?", (len(TABLES) + 1,)
        ).fetchall()
        if not found:
            for statement in TABLES.values():
                connection.execute(statement)
        elif dict(found) != TABLES or len(found) != len(
            TABLES
        ):  # a view may have no end, a trigger may delete
            raise UserError(f"{path}: holds something else than the trials of a sweep; {AGAIN}")
        stored = connection.execute("SELECT plan FROM plan").fetchone()
        if stored is None:
            connection.execute("INSERT INTO plan VALUES (?)", (plan,))
        elif stored[0] != plan:
            try:
                key, there, now = next(_differences(parsed_json(stored[0]), json.loads(plan)))
            except (StopIteration, TypeError, ValueError) as error:  # no text of ours
                raise UserError(f"{path}: the plan in it is damaged; {AGAIN}") from error
            raise UserError(
                f"{path}: holds trials of another sweep or of other settings ({key}: there {there}, now "
                f"{now}); name another folder with --out"
            )


def _differences(there: Any, now: Any, key: str = "") -> Iterator[tuple[str, str, str]]:
    """Each dotted key with another value, as short JSON, in two plans."""
    if not (isinstance(there, dict) and isinstance(now, dict)):
        if there != now:
            yield key, clipped(json.dumps(there), LONGEST_TOLD), clipped(json.dumps(now), LONGEST_TOLD)
        return
    for part in sorted(there.keys() | now.keys()):
        yield from _differences(there.get(part), now.get(part), f"{key}.{part}" if key else part)
