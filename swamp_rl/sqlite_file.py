"""SQLite files that may be damaged or hostile."""

import sqlite3

MOST_STEPS = 10**7
"Of SQLite to read a file's tables: some twenty for each."


def refuse_endless(connection: sqlite3.Connection) -> None:
    """sqlite3.DatabaseError where a file has rows without end, or other faults of its structure.

    By pages that lead to the same page many times, a file of 20 kB has more rows than can be read; by a view
    or a computed column, one of 1 kB. Where it is refused, the connection does little more.
    """
    connection.set_progress_handler(lambda: 1, MOST_STEPS)
    columns = "SELECT 1 FROM sqlite_schema AS t, pragma_table_xinfo(t.name) AS c WHERE c.hidden"
    try:
        kinds = {kind for (kind,) in connection.execute("SELECT DISTINCT type FROM sqlite_schema")}
        other = not kinds <= {"table", "index"} or connection.execute(columns).fetchone()
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode == sqlite3.SQLITE_INTERRUPT:
            raise sqlite3.DatabaseError("has tables without end") from error
        raise
    if other:
        raise sqlite3.DatabaseError("holds something else than tables and indices of them")
    connection.set_progress_handler(None, 0)
    (fault,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if fault != "ok":
        raise sqlite3.DatabaseError(f"is damaged ({' '.join(fault.split())})")
