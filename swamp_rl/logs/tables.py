"""CSV and Parquet tables as logs."""

import re
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.runs.missing_marks import without_marks
from swamp_rl.runs.table import read_table


def read_table_log(path: Path) -> Log:
    """The table of a file, named after the file; UserError where it cannot be read as a table at all."""
    table = without_marks(path.name, read_table(path))
    if not table.columns:
        raise UserError(f"{path.parent / str(table.faults[0])}; nothing was imported")
    name = table_name(path.stem)
    return Log(path.name, path.stem, {name: LogTable(name, table, kind="table", origin=path.name)})


def table_name(words: str) -> str:
    """A name that can stand in an expression, of a topic's or a file's."""
    name = re.sub(r"\W+", "_", words.strip("/ "), flags=re.ASCII).strip("_")
    return f"t_{name}" if not name or name[0].isdigit() else name
