"""From logs of other recorders to one dataset, by a mapping, whole or not at all."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from swamp_rl.errors import UserError
from swamp_rl.logs.convert import foreign_of
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapping import Mapping
from swamp_rl.logs.tables import read_table_log
from swamp_rl.runs.import_dataset import About, files_of_kind, import_tables
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.schema import DatasetMeta

LogKind = Literal["csv", "parquet"]


@dataclass(frozen=True)
class Reading:
    """How logs are read: the `mapping`; `join`: the files are tables of one run of this name."""

    mapping: Mapping
    join: str | None = None


def import_logs(
    sources: Sequence[Path], kind: LogKind, out: Path | str, about: About, wishes: Wishes, reading: Reading
) -> DatasetMeta:
    """Write the runs that a mapping makes of logs into the new dataset `out`; what it then says.

    UserError lists the faults with file, row and column, and then there is no `out`.
    """
    mapping = replace(reading.mapping, units={**reading.mapping.units, **wishes.units})
    unknown = [name for name in wishes.units if name not in mapping.columns]
    if unknown:
        raise UserError(f"--unit {unknown[0]}: the mapping has no such column; check the name")
    logs = [read_table_log(file) for file in files_of_kind(sources, kind)]
    if reading.join is not None:
        logs = [_as_one(logs, reading.join)]
    single = [foreign_of(log, mapping, wishes.resample, wishes.fill) for log in logs]
    even = all("joined" in (one.meta.model_extra or {}) for one in single)
    rest = replace(wishes, units={}, resample=None if even else wishes.resample)
    return import_tables(single, out, about, rest)


def _as_one(logs: Sequence[Log], name: str) -> Log:
    """The tables of several files as one log."""
    tables = {table.name: table for log in logs for table in log.tables.values()}
    return Log(" + ".join(Path(log.file).name for log in logs), name, tables)
