"""Bags of ROS 1 and ROS 2 (SQLite, MCAP with CDR), through rosbags."""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.logs.bag_metadata import refuse_odd_bag, refuse_odd_tables
from swamp_rl.logs.binary import LARGEST, Gathered, reading, refuse_other_bytes
from swamp_rl.logs.log import Log
from swamp_rl.logs.tables import table_name
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.kind_of_file import BAG_METADATA, mcap_profile
from swamp_rl.runs.table import MOST_COLUMNS

WHAT = "ROS bag"
PROFILE = "ros2"
"""Of the MCAP files that rosbags reads."""
UNDEFINED = (
    "which the bag does not define; convert it to MCAP (ros2 bag convert) where that package is installed"
)
REPAIRS = {".bag": "rosbag reindex", ".mcap": "mcap recover"}
MOST_NAMED = 12
LONGEST_ARRAY = 16
"""Elements that become columns of their own; covariances of 36 and pictures do not."""
MOST_BYTES = 2**32
"""Of the messages of the topics that are read."""
DEFINED = {
    f"mavros_msgs/msg/{name}": "std_msgs/Header header\nuint16[] channels\n" for name in ("RCOut", "RCIn")
}
"""Message types that bags of ROS 2 before Iron name without their definition, as mavros defines them."""
HEADER = tuple(f"header.stamp.{unit}" for unit in ("sec", "nanosec"))
LATEST = 10.0
"""Seconds between a header and its recording, by the median: beyond, they are of different clocks."""


def read_bag(path: Path, wanted: Collection[str] | None = None, kinds: Collection[str] = ()) -> Log:
    """The topics of a bag as tables, slashes in names as underscores; fields of fields with dots.

    The times [s] are those of the headers where all messages have one, else those of recording, on one clock.
    wanted: names of tables to be read, and all of the message types `kinds`; by default all. UserError for a
    damaged bag, or one without numbers.
    """
    with reading(path, WHAT, REPAIRS.get(path.suffix.lower(), "")), _opened(path) as reader:
        names = _names(connection.topic for connection in reader.connections)
        chosen = [
            one
            for one in reader.connections
            if wanted is None or names[one.topic] in wanted or one.msgtype.replace("/msg/", "/") in kinds
        ]
        unknown = _undefined(reader)
        if wanted is not None and (asked := [t for t in unknown if names[t] in wanted]):
            raise UserError(
                f"{path}: {clipped(asked[0])} is of type {clipped(unknown[asked[0]])}, {UNDEFINED}"
            )
        chosen = [one for one in chosen if one.topic not in unknown]
        tables: dict[str, Gathered] = {}
        headers: dict[str, list[float]] = {}
        size = 0
        for connection, stamp, data in reader.messages(connections=chosen) if chosen else ():
            size += len(data)
            if size > MOST_BYTES:
                raise UserError(f"{path}: has more than {MOST_BYTES / 2**30:g} GiB of messages; divide it")
            name = names[connection.topic]
            fields = dict(_numbers(reader.deserialize(data, connection.msgtype), reader.typestore))
            if name not in tables:
                kind = connection.msgtype.replace("/msg/", "/")
                tables[name] = Gathered(path, name, kind, connection.topic, HEADER)
                headers[name] = []
            tables[name].add(1e-9 * stamp, fields)
            headers[name].append(_header(fields))
    if not tables:
        raise UserError(f"{path}: holds no message of the topics that are read; see --list")
    metadata = _on_one_clock(tables, {name: own for name, own in headers.items() if min(own) > 0.0})
    start = min(min(table.stamps) for table in tables.values())
    for table in tables.values():
        table.stamps = [stamp - start for stamp in table.stamps]
    if unknown:
        some = ", ".join(f"{clipped(one)} ({clipped(unknown[one])})" for one in list(unknown)[:MOST_NAMED])
        metadata["not_read"] = f"{some}, {UNDEFINED}"
    metadata["utc_start"] = f"{start:.6f}"
    return Log(path.name, path.stem, {name: table.table() for name, table in tables.items()}, metadata)


def _undefined(reader: Any) -> dict[str, str]:
    """Types by topic that neither the bag nor ROS defines; those of DEFINED become known to the reader."""
    from rosbags.typesys import get_types_from_msg

    kinds = {one.topic: one.msgtype for one in reader.connections}
    for kind in {kind for kind in kinds.values() if kind in DEFINED} - reader.typestore.fielddefs.keys():
        reader.typestore.register(get_types_from_msg(DEFINED[kind], kind))
    known = reader.typestore.fielddefs
    return {topic: kind.replace("/msg/", "/") for topic, kind in kinds.items() if kind not in known}


def _on_one_clock(tables: Mapping[str, Gathered], headers: Mapping[str, list[float]]) -> dict[str, str]:
    """Put the times of headers in place of those of recording; what to tell of clocks that differ.

    Where all headers count on another clock, as that of a simulation, the times of messages without a header
    are converted to it. A header whose clock differs from those of the others is not used.
    """
    late = {name: float(np.median(np.subtract(tables[name].stamps, own))) for name, own in headers.items()}
    odd = [name for name, seconds in late.items() if abs(seconds) > LATEST]
    message = ""
    if odd and len(odd) == len(headers):
        longest = max(odd, key=lambda name: len(headers[name]))
        recorded, counted = np.sort(tables[longest].stamps), np.sort(headers[longest])
        for name in [name for name in tables if name not in headers]:
            tables[name].stamps = np.interp(tables[name].stamps, recorded, counted).tolist()
            message = f"of the headers, {late[longest]:.0f} s behind the recorder's clock; others converted"
    elif odd:
        some = ", ".join(clipped(name) for name in odd[:MOST_NAMED])
        message = f"of recording for {some}, whose headers have another clock"
    for name in headers:
        if name not in odd or len(odd) == len(headers):
            tables[name].stamps = headers[name]
    return {"times": message} if message else {}


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


def _numbers(message: Any, types: Any, before: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Numbers of a message by name, without the constants of its type; at most MOST_COLUMNS."""
    if depth > 8:
        return
    count = 0
    constants = {name for name, *_ in types.fielddefs[message.__msgtype__][0]}
    for name, value in vars(message).items():
        if name.startswith("__") or name in constants:
            continue
        if isinstance(value, bool | int | float | np.number):
            yield f"{before}{name}", value
            count += 1
        elif isinstance(value, np.ndarray) and value.size <= LONGEST_ARRAY and value.dtype.kind in "fiub":
            yield from ((f"{before}{name}[{i}]", one) for i, one in enumerate(value.tolist()))
        elif hasattr(value, "__dataclass_fields__"):
            yield from _numbers(value, types, f"{before}{name}.", depth + 1)
        if count > MOST_COLUMNS:
            return


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    default = get_typestore(Stores.ROS2_HUMBLE)
    if path.suffix.lower() == ".bag":
        ordinary(path, LARGEST)
        refuse_other_bytes(path, WHAT, b"#ROSBAG V")
        with AnyReader([path]) as reader:
            yield reader
    elif path.is_dir():
        refuse_odd_bag(path)
        with AnyReader([path], default_typestore=default) as reader:
            yield reader
    elif path.suffix.lower() in (".db3", ".mcap"):
        ordinary(path, LARGEST)
        if path.suffix.lower() == ".mcap" and (profile := mcap_profile(path)) not in (None, PROFILE):
            raise UserError(
                f"{path}: its MCAP profile is {clipped(repr(profile))}, of a bag {PROFILE}; name the .bag "
                "that a ros1 file was made of; ros2 bag convert writes others again"
            )
        if path.suffix.lower() == ".db3":
            refuse_odd_tables(path)
        with AnyReader([path], default_typestore=default) as reader:
            yield reader
    else:
        raise UserError(
            f"{path}: is no ROS bag; name a .bag, .db3 or .mcap file, or a folder with {BAG_METADATA}"
        )
