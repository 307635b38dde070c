"""Small good logs of autopilots, of ROS and of loggers of their own kind; what an attack then damages."""

import sqlite3
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.attack.samples import circle

SECONDS = 1_700_000_000
"""Since 1970, of the first message."""
OPTIONS = [
    "time=epoch_ms",
    "north=x / 100",
    "east=-`y` / 100",
    "heading=radians(compass)",
    "throttle_port=clip((pwm_left - 1500) / 400, -1, 1)",
    "throttle_starboard=(pwm_right - 1500) / 400",
]
"""What `--map` says of the table below."""


def stranger() -> dict[str, Any]:
    """Columns of a logger of its own: epoch in ms, cm, degrees, pulse widths."""
    run = circle()
    return {
        "epoch_ms": np.round(1000.0 * (SECONDS + run["time"])).astype(int),
        "x": 100.0 * run["north"],
        "y": -100.0 * run["east"],
        "compass": np.degrees(run["heading"]),
        "pwm_left": np.full(len(run["time"]), 1700),
        "pwm_right": np.full(len(run["time"]), 1650),
        "mode": ["MANUAL"] * len(run["time"]),
    }


def make_table(suffix: str) -> Callable[[Path], Path]:
    """Of a file with those columns, .csv or .parquet."""

    def make(folder: Path) -> Path:
        import pyarrow as pa
        import pyarrow.csv
        import pyarrow.parquet

        path = folder / f"one{suffix}"
        write = pyarrow.csv.write_csv if suffix == ".csv" else pyarrow.parquet.write_table
        write(pa.table(stranger()), path)
        return path

    return make


def make_matlab(folder: Path) -> Path:
    """A MATLAB file with the numbers of that table."""
    from scipy.io import savemat

    path = folder / "one.mat"
    numbers = {name: np.asarray(values, float) for name, values in stranger().items() if name != "mode"}
    savemat(path, numbers, oned_as="column")
    return path


def make_mapping(folder: Path) -> Path:
    """A mapping's file, beside the table that it is for."""
    make_table(".csv")(folder)
    rows = [f"  {name}: '{text}'" for name, text in (one.split("=", 1) for one in OPTIONS[:-2])]
    rows += [f"  throttle_{side}: {{value: 0.5, unit: percent}}" for side in ("port", "starboard")]
    (folder / "map.yaml").write_text("frame: ned\nclock: []\ncolumns:\n" + "\n".join(rows) + "\n")
    return folder / "map.yaml"


def make_dataflash(folder: Path, rows: int = 12) -> Path:
    """Of ArduPilot: places, attitudes and the pulses of two outputs, so many of each."""
    formats = {
        "GPS": (130, "QLLff", "TimeUS,Lat,Lng,Spd,GCrs"),
        "ATT": (131, "QBf", "TimeUS,I,Yaw"),
        "RCOU": (132, "QHH", "TimeUS,C1,C3"),
        "PARM": (133, "QNf", "TimeUS,Name,Value"),
        "FMTU": (134, "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
    }
    sizes = {"Q": "Q", "L": "i", "f": "f", "H": "H", "B": "B", "N": "16s", "n": "4s", "Z": "64s"}
    bodies = {name: struct.Struct("<" + "".join(sizes[c] for c in one[1])) for name, one in formats.items()}
    out = bytearray()
    for name, (kind, letters, columns) in {
        "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns")
    }.items() | formats.items():
        length = 89 if name == "FMT" else 3 + bodies[name].size
        entries = (name.encode(), letters.encode(), columns.encode())
        out += b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", kind, length, *entries)

    def add(name: str, *values: Any) -> bytes:
        return b"\xa3\x95" + bytes([formats[name][0]]) + bodies[name].pack(*values)

    out += add("FMTU", 0, 131, b"s#d", b"F-0")
    for name, value in (("SERVO1_FUNCTION", 73.0), ("SERVO3_FUNCTION", 74.0)):
        out += add("PARM", 0, name.encode(), value)
    for i in range(rows):
        time, yaw = 10**8 + 10**5 * i, float(i % 20)
        out += add("GPS", time, 443000000 + 9 * i, 91500000, 1.0, yaw)
        out += add("ATT", time, 0, yaw) + add("ATT", time, 1, 0.6) + add("RCOU", time, 1700, 1650)
    (folder / "one.bin").write_bytes(bytes(out))
    return folder / "one.bin"


def make_ulog(folder: Path) -> Path:
    """Of PX4: places, two instances of attitudes, and two motors."""
    topics = {
        "vehicle_local_position": "float x;float y;float vx;float vy;",
        "vehicle_attitude": "float[4] q;",
        "actuator_motors": "float[2] control;uint8_t mode;uint8_t[7] _padding0;",
    }
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))

    def add(kind: str, body: bytes) -> bytes:
        return struct.pack("<HB", len(body), ord(kind)) + body

    out += add("B", bytes(40)) + add("I", b"\x0dchar[4] ver_swv1.0") + add("P", b"\x09float BAT" + bytes(4))
    for name, fields in topics.items():
        out += add("F", f"{name}:uint64_t timestamp;{fields}".encode())
    for number, name in enumerate([*topics, "vehicle_attitude"]):
        out += add("A", struct.pack("<BH", number // 3, number) + name.encode())
    for i in range(12):
        time = 10**7 + 10**5 * i
        out += add("D", struct.pack("<HQ4f", 0, time, 0.1 * i, 0.0, 1.0, 0.0))
        for number in (1, 3):
            out += add("D", struct.pack("<HQ4f", number, time, 1.0, 0.0, 0.0, 0.0))
        out += add("D", struct.pack("<HQ2fB", 2, time, 0.5, 0.4, 1))
    out += add("L", b"6" + struct.pack("<Q", 10**7) + b"a line") + add("O", struct.pack("<H", 9))
    (folder / "one.ulg").write_bytes(bytes(out))
    return folder / "one.ulg"


def make_bag(storage: str, part: str = "") -> Callable[[Path], Path]:
    """Of a bag of ROS (ros1, sqlite3 or mcap), or of the file of one whose name ends with `part`."""

    def make(folder: Path) -> Path:
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore

        one = storage == "ros1"
        store: Any = get_typestore(Stores.ROS1_NOETIC if one else Stores.ROS2_HUMBLE)
        plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
        path = folder / ("one.bag" if one else "bag")
        writer: Any = Writer1(path) if one else Writer(path, version=8, storage_plugin=plugin)
        write = store.serialize_ros1 if one else store.serialize_cdr
        kinds = {"/pose": "geometry_msgs/msg/PoseStamped"}
        kinds |= {f"/{side}/throttle": "std_msgs/msg/Float64" for side in ("port", "starboard")}
        with writer:
            topics = {
                name: writer.add_connection(name, kind, typestore=store) for name, kind in kinds.items()
            }
            for i in range(12):
                stamp = 10**9 * SECONDS + 10**8 * i
                for name, topic in topics.items():
                    message = _message(store.types, name, i, stamp, one)
                    writer.write(topic, stamp, write(message, topic.msgtype))
        if one:
            return path
        (file,) = [found for found in path.iterdir() if found.name.endswith(part or "") and part] or [path]
        if file.suffix == ".db3":
            with sqlite3.connect(file) as connection:
                connection.execute("PRAGMA page_size = 512")
            connection.execute("VACUUM")
            connection.close()
        return file

    return make


def _message(kinds: Any, topic: str, i: int, stamp: int, one: bool) -> Any:
    if topic != "/pose":
        return kinds["std_msgs/msg/Float64"](data=0.5)
    time = kinds["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = kinds["std_msgs/msg/Header"](stamp=time, frame_id="map", **({"seq": i} if one else {}))
    place = kinds["geometry_msgs/msg/Point"](x=0.1 * i, y=0.0, z=0.0)
    turned = kinds["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    pose = kinds["geometry_msgs/msg/Pose"](position=place, orientation=turned)
    return kinds["geometry_msgs/msg/PoseStamped"](header=header, pose=pose)
