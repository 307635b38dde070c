"""PX4's logs (.ulg), through pyulog."""

from collections.abc import Collection
from pathlib import Path

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.logs.binary import LARGEST, reading, refuse_other_bytes
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS, Table

WHAT = "ULog file"
CLOCKS = "timestamp_sample", "time_utc_usec"


def read_ulog(path: Path, wanted: Collection[str] | None = None) -> Log:
    """The topics of a log, `NAME_1` for a second instance; times from `timestamp` [s], since the boot.

    wanted: names of tables to be read, all by default. Parameters are in `metadata`, as `parameter NAME`.
    UserError for a damaged file, or one without data.
    """
    with reading(path, WHAT):
        from pyulog import ULog

        ordinary(path, LARGEST)
        refuse_other_bytes(path, WHAT, b"ULog\x01\x12\x35")
        names = None if wanted is None else sorted({*wanted, *(n.rpartition("_")[0] for n in wanted)} - {""})
        log = ULog(str(path), names)
        tables = {}
        for found in log.data_list:
            name = table_name(f"{found.name}_{found.multi_id}" if found.multi_id else found.name)
            stamps = found.data.get("timestamp")
            if stamps is None or (wanted is not None and name not in wanted):
                continue
            if stamps.size * len(found.data) > MOST_CELLS:
                raise UserError(f"{path}: {name} has more than {MOST_CELLS} values; divide the log")
            columns = {
                field: np.asarray(values, float)
                for field, values in list(found.data.items())[:MOST_COLUMNS]
                if field != "timestamp"
            }
            table = Table(columns, np.arange(1, len(stamps) + 1))
            tables[name] = LogTable(name, table, 1e-6 * np.asarray(stamps, float), "ULog", found.name, CLOCKS)
    if not tables:
        raise UserError(f"{path}: holds no data of the topics that are read; see --list")
    metadata = {f"parameter {name}": str(value) for name, value in log.initial_parameters.items()}
    if log.file_corruption:
        metadata["log_damage"] = "the reader skipped damaged data"
    return Log(path.name, path.stem, tables, metadata)
