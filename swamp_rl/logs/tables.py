"""CSV and Parquet tables as logs."""

import os
import re
from collections.abc import Collection, Sequence
from pathlib import Path

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.runs.schema import META
from swamp_rl.runs.table import read_table


def read_table_log(path: Path) -> Log:
    """The table of a file, named after the file; UserError where it cannot be read as a table at all."""
    name = table_name(path.stem)
    home = path.parent if (path.parent / META).is_file() else None
    return Log(path.name, path.stem, {name: _read(path, name, path.name)}, home=home)


def read_folder_log(folder: Path, files: Sequence[Path], wanted: Collection[str] | None = None) -> Log:
    """The files of a folder and of the folders in it as the tables of one log, named by their paths.

    wanted: names of the tables that are needed, all by default; the others are not read, nor are empty files.
    UserError for a wanted table that is not there, and where one cannot be read.
    """
    root = os.path.commonpath([file.parent for file in files])
    named: dict[str, Path] = {}
    for file in files:
        name = table_name(file.relative_to(root).with_suffix("").as_posix())
        if name in named:
            raise UserError(f"{file}: is the table {name} like {named[name]}; rename one")
        named[name] = file
    for name in wanted or ():
        if name not in named:
            raise UserError(
                f"{folder}: --map: there is no table {clipped(name)!r}{nearest(name, list(named))}"
            )
    empty = [name for name, file in named.items() if not file.stat().st_size]
    kept = [name for name in (named if wanted is None else wanted) if name not in empty]
    tables = {name: _read(named[name], name, str(named[name].relative_to(folder))) for name in kept}
    metadata = {"not_read": f"{', '.join(empty)} (empty)"} if empty and wanted is None else {}
    return Log(folder.name, folder.name, tables, metadata)


def _read(path: Path, name: str, origin: str) -> LogTable:
    table = read_table(path)
    if not table.columns:
        raise UserError(f"{path.parent / str(table.faults[0])}; nothing was imported")
    return LogTable(name, table, kind="table", origin=origin)


def table_name(words: str) -> str:
    """A name that can stand in an expression, of a topic's or a file's."""
    name = re.sub(r"\W+", "_", words.strip("/ "), flags=re.ASCII).strip("_")
    return f"t_{name}" if not name or name[0].isdigit() else name
