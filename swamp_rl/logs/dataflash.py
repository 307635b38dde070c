"""ArduPilot's DataFlash logs (.bin), through pymavlink."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from swamp_rl.errors import UserError
from swamp_rl.logs.binary import LARGEST, Gathered, reading, refuse_other_bytes
from swamp_rl.logs.log import Log
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import ordinary

WHAT = "DataFlash log"
PARAMETER = "PARM"
HEADER = 3
"""Bytes of a message before its fields."""
CLOCKS = "TimeUS", "TimeMS", "GMS", "GWk"
"""Fields of the time since the boot, and of GPS time."""
MOST_MESSAGES = 50_000_000


def read_dataflash(path: Path, wanted: Collection[str] | None = None) -> Log:
    """The messages of a log by type, `GPS_1` for those of a second instance; times [s] since the boot.

    wanted: names of tables to be read, all by default. Values are scaled as the format says.
    Parameters are in `metadata`, as `parameter NAME`. UserError for a damaged file, or one without a message.
    """
    with reading(path, WHAT):
        ordinary(path, LARGEST)
        refuse_other_bytes(path, WHAT, b"\xa3\x95")
        reader = _opened(path)
        try:
            return _gathered(path, reader, wanted)
        finally:
            reader.close()


class _Formats(dict[int, Any]):
    """Formats of messages by type, each with a length that leads to the next message."""

    def __setitem__(self, kind: int, format: Any) -> None:
        if format.len < HEADER:
            raise ValueError(f"messages of type {kind} have a length of {format.len} bytes")
        super().__setitem__(kind, format)


def _opened(path: Path) -> Any:
    from pymavlink import DFReader

    class Reader(DFReader.DFReader_binary):
        """As the library has it, but for its faster index, which ends the process at an unknown message."""

        def init_arrays(self, progress_callback: Any = None) -> None:
            self.formats: Any = _Formats(self.formats)
            super().init_arrays(progress_callback)

        init_arrays_fast = init_arrays

    return Reader(str(path), zero_time_base=True)


def _gathered(path: Path, reader: Any, wanted: Collection[str] | None) -> Log:
    tables: dict[str, Gathered] = {}
    metadata: dict[str, str] = {}
    types = None if wanted is None else {name.rpartition("_")[0] or name for name in wanted} | set(wanted)
    asked = None if types is None else [*types, PARAMETER]
    for _ in range(MOST_MESSAGES):
        message = reader.recv_match(type=asked) if asked else reader.recv_msg()
        if message is None:
            break
        kind, fields = message.get_type(), message.to_dict()
        if kind == PARAMETER and "Name" in fields:
            metadata[f"parameter {fields['Name']}"] = str(fields.get("Value"))
        stamp = _since_boot(kind, fields)
        if stamp is None:
            continue
        instance = fields.get(message.fmt.instance_field) if message.fmt.instance_field else 0
        name = table_name(f"{kind}_{instance}" if instance else kind)
        if wanted is not None and name not in wanted:
            continue
        if name not in tables:
            tables[name] = Gathered(path, name, "DataFlash", kind, CLOCKS)
        tables[name].add(stamp, {field: one for field, one in fields.items() if isinstance(one, int | float)})
    if not tables:
        raise UserError(f"{path}: holds no message with a time (TimeUS, TimeMS); name a whole DataFlash log")
    return Log(path.name, path.stem, {name: table.table() for name, table in tables.items()}, metadata)


def _since_boot(kind: str, fields: dict[str, Any]) -> float | None:
    """Seconds since the boot: TimeUS; before 2015 TimeMS, which of a receiver is GPS time beside its T."""
    receiver = kind.startswith("GPS")
    for name, ticks in (("TimeUS", 1e6), ("T" if receiver else "TimeMS", 1e3)):
        stamp = fields.get(name)
        if isinstance(stamp, int | float):
            return stamp / ticks
    return None
