"""Bags of ROS 1 and ROS 2 (SQLite, MCAP with CDR), through rosbags."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.logs.binary import LARGEST, Gathered, reading
from swamp_rl.logs.log import Log
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.table import MOST_COLUMNS

WHAT = "ROS bag"
METADATA = "metadata.yaml"
STORAGES = {".db3": "sqlite3", ".mcap": "mcap"}
LONGEST_ARRAY = 16
"""Elements that become columns of their own; covariances of 36 and pictures do not."""
MOST_BYTES = 2**32
"""Of the messages of the topics that are read."""
LARGEST_METADATA = 2**23


def is_bag_folder(path: Path) -> bool:
    """Whether a folder is a bag of ROS 2."""
    return path.is_dir() and (path / METADATA).is_file()


def read_bag(path: Path, wanted: Collection[str] | None = None, kinds: Collection[str] = ()) -> Log:
    """The topics of a bag as tables, slashes in names as underscores; fields of fields with dots.

    The times [s] are those of the headers where all messages have one, else those of recording. wanted: names
    of tables to be read, and all of the message types `kinds`; by default all. UserError for a damaged bag,
    or one without numbers.
    """
    with reading(path, WHAT), _opened(path) as reader:
        names = _names(connection.topic for connection in reader.connections)
        chosen = [
            one
            for one in reader.connections
            if wanted is None or names[one.topic] in wanted or one.msgtype.replace("/msg/", "/") in kinds
        ]
        tables: dict[str, Gathered] = {}
        headers: dict[str, list[float]] = {}
        size = 0
        for connection, stamp, data in reader.messages(connections=chosen) if chosen else ():
            size += len(data)
            if size > MOST_BYTES:
                raise UserError(f"{path}: has more than {MOST_BYTES / 2**30:g} GiB of messages; divide it")
            name = names[connection.topic]
            fields = dict(_numbers(reader.deserialize(data, connection.msgtype)))
            if name not in tables:
                kind = connection.msgtype.replace("/msg/", "/")
                tables[name] = Gathered(path, name, kind, connection.topic, list(fields))
                headers[name] = []
            tables[name].add(1e-9 * stamp, [fields.get(field) for field in tables[name].names])
            headers[name].append(_header(fields))
    for name, stamps in headers.items():
        if stamps and min(stamps) > 0.0:
            tables[name].stamps = stamps
    if not tables:
        raise UserError(f"{path}: holds no message of the topics that are read; see --list")
    start = min(min(table.stamps) for table in tables.values())
    for table in tables.values():
        table.stamps = [stamp - start for stamp in table.stamps]
    told = {"utc_start": f"{start:.6f}"}
    return Log(path.name, path.stem, {name: table.table() for name, table in tables.items()}, told)


def _names(topics: Iterator[str]) -> dict[str, str]:
    """Names of tables by topic, each of its own."""
    found: dict[str, str] = {}
    for topic in dict.fromkeys(topics):
        name = table_name(topic)
        while name in found.values():
            name += "_"
        found[topic] = name
    return found


def _header(fields: dict[str, Any]) -> float:
    seconds = fields.get("header.stamp.sec", 0.0)
    return float(seconds) + 1e-9 * float(fields.get("header.stamp.nanosec", 0.0))


def _numbers(message: Any, before: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Numbers of a message by name, at most MOST_COLUMNS."""
    if depth > 8:
        return
    count = 0
    for name, value in vars(message).items():
        if name.startswith("__"):
            continue
        if isinstance(value, bool | int | float | np.number):
            yield f"{before}{name}", value
            count += 1
        elif isinstance(value, np.ndarray) and value.size <= LONGEST_ARRAY and value.dtype.kind in "fiub":
            yield from ((f"{before}{name}[{i}]", one) for i, one in enumerate(value.tolist()))
        elif hasattr(value, "__dataclass_fields__"):
            yield from _numbers(value, f"{before}{name}.", depth + 1)
        if count > MOST_COLUMNS:
            return


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    default = get_typestore(Stores.ROS2_HUMBLE)
    if path.suffix.lower() == ".bag":
        ordinary(path, LARGEST)
        with AnyReader([path]) as reader:
            yield reader
    elif path.is_dir():
        _refuse_odd_files(path)
        with AnyReader([path], default_typestore=default) as reader:
            yield reader
    else:
        ordinary(path, LARGEST)
        with TemporaryDirectory() as scratch:
            folder = _as_folder(path, Path(scratch))
            with AnyReader([folder], default_typestore=default) as reader:
                yield reader


def _refuse_odd_files(folder: Path) -> None:
    """UserError where the files that the folder's description names are not ordinary ones in it."""
    ordinary(folder / METADATA, LARGEST_METADATA)
    told = read_yaml(folder / METADATA).get("rosbag2_bagfile_information")
    if not isinstance(told, dict) or not isinstance(told.get("relative_file_paths"), list):
        raise UserError(f"{folder / METADATA}: names no relative_file_paths; copy the bag again")
    if str(told.get("compression_mode") or "").lower() == "file":
        raise UserError(f"{folder}: its files are compressed as a whole; decompress them (ros2 bag convert)")
    for name in told["relative_file_paths"]:
        path = folder / Path(str(name)).name
        if path.is_symlink():
            raise UserError(f"{path}: is a link; put a copy of the file in its place")
        ordinary(path, LARGEST)


def _as_folder(path: Path, scratch: Path) -> Path:
    """A folder with the description that a lone .db3 or .mcap file lacks, and a link to it."""
    from rosbags.rosbag2.storage_mcap import McapReader
    from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

    storage = STORAGES.get(path.suffix.lower())
    if storage is None:
        raise UserError(
            f"{path}: is no ROS bag; name a .bag, .db3 or .mcap file, or a folder with {METADATA}"
        )
    reader = (McapReader if storage == "mcap" else Sqlite3Reader)(path)
    reader.open()
    try:
        topics = [
            {
                "topic_metadata": {
                    "name": one.topic,
                    "type": one.msgtype,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": "",
                },
                "message_count": 0,
            }
            for one in reader.connections
        ]
    finally:
        reader.close()
    (scratch / path.name).symlink_to(path.resolve())
    whole = {
        "version": 5,
        "storage_identifier": storage,
        "relative_file_paths": [path.name],
        "duration": {"nanoseconds": 0},
        "starting_time": {"nanoseconds_since_epoch": 0},
        "message_count": 0,
        "topics_with_message_count": topics,
        "compression_format": "",
        "compression_mode": "",
    }
    write_yaml(scratch / METADATA, {"rosbag2_bagfile_information": whole})
    return scratch
