"""Formats that other programmes write: a good file of each, and the reader that meets a bad one."""

import functools
import pickle
import shutil
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

from benchmarks.attack.log_samples import (
    OPTIONS,
    make_bag,
    make_dataflash,
    make_mapping,
    make_matlab,
    make_table,
    make_ulog,
)
from benchmarks.attack.samples import make_boat, make_text

Make, Read = Callable[[Path], Path], Callable[[Path], Any]
KINDS = {".csv": "csv", ".parquet": "parquet", ".mat": "matlab", ".bin": "dataflash", ".ulg": "ulog"}


def imported(log: Path, options: Sequence[str], beside: Path, clock: Sequence[str] = ()) -> Any:
    """What importing a log says, for a boat whose file is put beside it; listed, too, as `--list` does."""
    from swamp_rl.logs.import_logs import Reading, import_logs, read_log
    from swamp_rl.logs.listing import listing
    from swamp_rl.logs.mapping import mapping_of
    from swamp_rl.runs.import_dataset import About
    from swamp_rl.runs.import_foreign import Wishes

    kind = KINDS.get(log.suffix, "rosbag")
    boat, out = beside / "boat.yaml", beside / "imported"
    if not boat.exists():
        make_boat("twin-fixed")(beside)
    shutil.rmtree(out, ignore_errors=True)
    reading = Reading(mapping_of(options, clock=clock))
    listed = all(line.isprintable() for line in listing(read_log(log, kind)))
    assert listed, "a line of the list does not print"
    return import_logs([log], kind, out, About(str(boat)), Wishes(), reading)


def by(*options: str) -> Read:
    """The reader of a log with these mappings besides its usual one."""
    return lambda path: imported(path, options, path.parent)


def _bag(path: Path) -> Any:
    """The reader of the folder of a bag, one of whose files is at `path`."""
    return imported(path.parent, POSE, path.parent.parent)


def _mapping(path: Path) -> Any:
    return imported(path.with_name("one.csv"), [str(path)], path.parent)


def _expression(path: Path) -> Any:
    """One option of the command line more, for a column that the table has besides."""
    table = path.with_name("one.csv")
    if not table.exists():
        make_table(".csv")(path.parent)
    text = path.read_bytes().decode("utf-8", "surrogateescape")
    return imported(table, [*OPTIONS, f"wind_speed={text}"], path.parent)


def _clock(path: Path) -> Any:
    log = path.with_name("one.bin")
    if not log.exists():
        make_dataflash(path.parent, rows=90)
    text = path.read_bytes().decode("utf-8", "surrogateescape")
    from swamp_rl.logs import import_logs

    with patch.object(import_logs, "read_log", _read_once):
        return imported(log, (), path.parent, [text])


def _read_once(log: Path, kind: str, wanted: Collection[str] | None = None) -> Any:
    """In place of `read_log`, of a log that no input changes."""
    return pickle.loads(_remembered(log, kind, None if wanted is None else tuple(sorted(wanted))))


@functools.lru_cache(maxsize=64)
def _remembered(log: Path, kind: str, wanted: tuple[str, ...] | None) -> bytes:
    from swamp_rl.logs.dataflash import read_dataflash

    assert kind == "dataflash"
    return pickle.dumps(read_dataflash(log, wanted))


POSE = ["x=pose.pose.position.x", "y=pose.pose.position.y"]
POSE += [f"q{axis}=pose.pose.orientation.{axis}" for axis in "wxyz"]
MOTORS = [f"throttle_{side}=actuator_motors.control[{i}]" for i, side in enumerate(("port", "starboard"))]
LOG_FORMATS: dict[str, tuple[Make, Read]] = {
    "dataflash.bin": (make_dataflash, by()),
    "px4.ulg": (make_ulog, by(*MOTORS)),
    "ros1.bag": (make_bag("ros1"), by(*POSE)),
    "ros2.db3": (make_bag("sqlite3", ".db3"), by(*POSE)),
    "ros2.mcap": (make_bag("mcap", ".mcap"), by(*POSE)),
    "ros2 metadata.yaml": (make_bag("mcap", ".yaml"), _bag),
    "mapped.csv": (make_table(".csv"), by(*OPTIONS)),
    "mapped.mat": (make_matlab, by(*OPTIONS)),
    "mapped.parquet": (make_table(".parquet"), by(*OPTIONS)),
    "mapping.yaml": (make_mapping, _mapping),
    "--map": (make_text("where(x > 50, abs(`y`) / 1e2, -rate(compass)) ** 2"), _expression),
    "--clock": (make_text("turn_rate(radians(ATT.Yaw)) ~ rate(GPS.GCrs) / 9"), _clock),
}
"""Of each name the maker and the reader."""
