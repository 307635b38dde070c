"""Small logs of the weaving boat in the formats of autopilots and ROS, written for the tests (scripted)."""

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tests.support.logs import geodetic, weaving

SIZES = {
    "Q": ("Q", 1),
    "I": ("I", 1),
    "L": ("i", 1e-7),
    "f": ("f", 1.0),
    "H": ("H", 1.0),
    "B": ("B", 1.0),
    "N": ("16s", 1.0),
}


def dataflash(
    path: Path, seconds: float = 30.0, old: bool = False, rate: float = 5.0, boots: int = 1
) -> Path:
    """GPS at 5 Hz or `rate`, ATT, IMU and RCOU at 10 Hz, outputs 1 and 3 as ThrottleLeft and ThrottleRight.

    boots: how often the whole is written, each time from the same time since the boot; old: as before
    2015, with TimeMS [ms], which of GPS is the time of its week, beside T [ms].
    """
    run, slow = weaving(seconds), weaving(seconds, rate)
    records: list[tuple[float, bytes]] = []
    out = bytearray()
    formats = {
        "GPS": (130, "QLLff", "TimeUS,Lat,Lng,Spd,GCrs"),
        "ATT": (131, "Qf", "TimeUS,Yaw"),
        "IMU": (132, "Qf", "TimeUS,GyrZ"),
        "RCOU": (133, "QHHH", "TimeUS,C1,C2,C3"),
        "PARM": (134, "QNf", "TimeUS,Name,Value"),
    }
    if old:
        formats = {
            name: (kind, letters.replace("Q", "I"), columns.replace("US", "MS"))
            for name, (kind, letters, columns) in formats.items()
        }
        formats["GPS"] = (130, "ILLffI", "TimeMS,Lat,Lng,Spd,GCrs,T")
    for name, (kind, letters, columns) in {
        "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns")
    }.items() | formats.items():
        length = 89 if name == "FMT" else 3 + struct.calcsize("<" + "".join(SIZES[c][0] for c in letters))
        out += b"\xa3\x95\x80" + struct.pack(
            "<BB4s16s64s", kind, length, name.encode(), letters.encode(), columns.encode()
        )

    def add(name: str, time: float, *values: Any) -> None:
        kind, letters, _ = formats[name]
        packed = [
            value
            if isinstance(value, bytes)
            else value / SIZES[letter][1]
            if letter in "f"
            else round(value / SIZES[letter][1])
            for letter, value in zip(letters[1:], values, strict=True)
        ]
        ticks = 1e3 * (time + (2e5 if name == "GPS" else 100.0)) if old else 1e6 * (time + 100.0)
        body = struct.pack("<" + "".join(SIZES[c][0] for c in letters), round(ticks), *packed)
        records.append((time, b"\xa3\x95" + bytes([kind]) + body))

    for name, value in (("SERVO1_FUNCTION", 73), ("SERVO3_FUNCTION", 74), ("SERVO3_REVERSED", 0)):
        add("PARM", -1.0, name.encode(), value)
    latitude, longitude = geodetic(slow)
    for i, time in enumerate(slow["time"].tolist()):
        speed, course = (
            np.hypot(slow["surge"][i], slow["sway"][i]),
            np.arctan2(slow["sway"][i], slow["surge"][i]),
        )
        add(
            "GPS",
            time,
            latitude[i],
            longitude[i],
            speed,
            float(np.degrees(slow["heading"][i] + course) % 360.0),
            *([1e3 * (time + 100.0)] if old else []),
        )
    for i, time in enumerate(run["time"].tolist()):
        add("ATT", time, float(np.degrees(run["heading"][i]) % 360.0))
        add("IMU", time, run["yaw_rate"][i])
        pulses = [1500 + 400 * run[f"throttle_{side}"][i] for side in ("port", "starboard")]
        add("RCOU", time, pulses[0], 1500, pulses[1])
    once = b"".join(body for _, body in sorted(records, key=lambda one: one[0]))
    path.write_bytes(bytes(out) + boots * once)
    return path


def ulog(path: Path, seconds: float = 30.0) -> Path:
    """vehicle_local_position and actuator_motors, starboard first, at 10 Hz, vehicle_attitude at 20 Hz."""
    from pyulog import ULog

    run, fast = weaving(seconds), weaving(seconds, 20.0)
    cos, sin = np.cos(run["heading"]), np.sin(run["heading"])
    north = run["surge"] * cos - run["sway"] * sin
    east = run["surge"] * sin + run["sway"] * cos
    half = 0.5 * fast["heading"]
    zero = np.zeros_like(half)
    made = {
        "vehicle_local_position": (run, {"x": run["north"], "y": run["east"], "vx": north, "vy": east}),
        "vehicle_attitude": (
            fast,
            {f"q[{i}]": v for i, v in enumerate((np.cos(half), zero, zero, np.sin(half)))},
        ),
        "actuator_motors": (
            run,
            {f"control[{i}]": run[f"throttle_{side}"] for i, side in enumerate(("starboard", "port"))},
        ),
    }
    out = bytearray(ULog.HEADER_BYTES + b"\x01" + struct.pack("<Q", 0))
    out += struct.pack("<HB", 40, ord("B")) + bytes(40)
    for name, (_, columns) in made.items():
        arrays: dict[str, int] = {}
        for column in columns:
            stem = column.partition("[")[0]
            arrays[stem] = arrays.get(stem, 0) + 1
        parts = [
            f"float[{count}] {stem};" if count > 1 else f"float {stem};" for stem, count in arrays.items()
        ]
        text = f"{name}:uint64_t timestamp;{''.join(parts)}".encode()
        out += struct.pack("<HB", len(text), ord("F")) + text
    for number, name in enumerate(made):
        own = struct.pack("<BH", 0, number) + name.encode()
        out += struct.pack("<HB", len(own), ord("A")) + own
    for number, (of, columns) in enumerate(made.values()):
        for i, time in enumerate(of["time"].tolist()):
            body = struct.pack("<HQ", number, round(1e6 * (time + 50.0)))
            body += struct.pack(f"<{len(columns)}f", *(values[i] for values in columns.values()))
            out += struct.pack("<HB", len(body), ord("D")) + body
    path.write_bytes(bytes(out))
    return path


def bag(
    path: Path,
    storage: str,
    seconds: float = 30.0,
    headers_late: float = 0.0,
    pause: tuple[float, float] = (0.0, 0.0),
) -> Path:
    """An Odometry at 10 Hz (ENU, body FLU) and a Float64 for each thruster; ros1, sqlite3 or mcap.

    Topics offer a quality of service, as those that `ros2 bag record` writes. headers_late [s]: the headers'
    clock is this much behind the recorder's. pause [s]: between these times nothing is recorded.
    """
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    one = storage == "ros1"
    store: Any = get_typestore(Stores.ROS1_NOETIC if one else Stores.ROS2_HUMBLE)
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    writer: Any = Writer1(path) if one else Writer(path, version=8, storage_plugin=plugin)
    run = weaving(seconds)
    offered: dict[str, Any] = {}
    if not one:
        any_time = QosTime(2147483647, 4294967295)
        keeping = (QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL)
        living = (any_time, any_time, QosLiveliness.AUTOMATIC, any_time, False)
        offered = {"offered_qos_profiles": [Qos(*keeping, *living)]}
    with writer:
        odometry = writer.add_connection(
            "/boat/odometry", "nav_msgs/msg/Odometry", typestore=store, **offered
        )
        throttles = {
            side: writer.add_connection(
                f"/thrusters/{side}/throttle", "std_msgs/msg/Float64", typestore=store, **offered
            )
            for side in ("port", "starboard")
        }
        write = store.serialize_ros1 if one else store.serialize_cdr
        for i, time in enumerate(run["time"].tolist()):
            if pause[0] < time < pause[1]:
                continue
            stamp = round(1e9 * (1_700_000_000.0 + time))
            message = _odometry(store, run, i, stamp - round(1e9 * headers_late), one)
            writer.write(odometry, stamp, write(message, odometry.msgtype))
            for side, connection in throttles.items():
                number = store.types["std_msgs/msg/Float64"](data=float(run[f"throttle_{side}"][i]))
                writer.write(connection, stamp, write(number, connection.msgtype))
    return path


def _odometry(store: Any, run: dict[str, Any], i: int, stamp: int, one: bool) -> Any:
    kinds = store.types
    time = kinds["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    sequence = {"seq": i} if one else {}
    header = kinds["std_msgs/msg/Header"](stamp=time, frame_id="map", **sequence)
    vector, covariance = kinds["geometry_msgs/msg/Vector3"], np.zeros(36)
    yaw = 0.5 * np.pi - run["heading"][i]
    w, z = float(np.cos(yaw / 2)), float(np.sin(yaw / 2))
    turned = kinds["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=z, w=w)
    place = kinds["geometry_msgs/msg/Point"](x=float(run["east"][i]), y=float(run["north"][i]), z=0.0)
    pose = kinds["geometry_msgs/msg/Pose"](position=place, orientation=turned)
    twist = kinds["geometry_msgs/msg/Twist"](
        linear=vector(x=float(run["surge"][i]), y=-float(run["sway"][i]), z=0.0),
        angular=vector(x=0.0, y=0.0, z=-float(run["yaw_rate"][i])),
    )
    return kinds["nav_msgs/msg/Odometry"](
        header=header,
        child_frame_id="base_link",
        pose=kinds["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=covariance),
        twist=kinds["geometry_msgs/msg/TwistWithCovariance"](twist=twist, covariance=covariance),
    )


def receiver_bag(
    path: Path, velocity_of: str, delay: float = 0.0, topics: Sequence[str] = ("/fix", "/vel", "/imu")
) -> Path:
    """A ROS 1 bag of NavSatFix at 5 Hz, Imu at 20 Hz (ENU) and a TwistStamped in axes of the earth or body.

    delay [s]: of the Imu's stamps against the receiver's.
    """
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store: Any = get_typestore(Stores.ROS1_NOETIC)
    kinds, run, fast = store.types, weaving(rate=5.0), weaving(rate=20.0)
    vector, zero = kinds["geometry_msgs/msg/Vector3"], np.zeros(9)
    latitude, longitude = geodetic(run)
    status = kinds["sensor_msgs/msg/NavSatStatus"](status=2, service=1)

    def header(time: float) -> Any:
        stamp = kinds["builtin_interfaces/msg/Time"](
            sec=1_700_000_000 + int(time), nanosec=round(1e9 * (time % 1))
        )
        return kinds["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id="")

    def twist(i: int) -> Any:
        surge, sway, heading = (float(run[name][i]) for name in ("surge", "sway", "heading"))
        north = surge * np.cos(heading) - sway * np.sin(heading)
        east = surge * np.sin(heading) + sway * np.cos(heading)
        x, y = (east, north) if velocity_of == "earth" else (surge, -sway)
        return kinds["geometry_msgs/msg/Twist"](
            linear=vector(x=float(x), y=float(y), z=0.0), angular=vector(x=0.0, y=0.0, z=0.0)
        )

    made: list[tuple[float, str, Any]] = []
    for i, time in enumerate(run["time"].tolist()):
        fix = kinds["sensor_msgs/msg/NavSatFix"](
            header=header(time),
            status=status,
            latitude=latitude[i],
            longitude=longitude[i],
            altitude=0.0,
            position_covariance=zero,
            position_covariance_type=0,
        )
        made.append((time, "/fix", fix))
        made.append(
            (time, "/vel", kinds["geometry_msgs/msg/TwistStamped"](header=header(time), twist=twist(i)))
        )
    for i, time in enumerate((fast["time"] + delay).tolist()):
        yaw = 0.5 * np.pi - fast["heading"][i]
        turned = kinds["geometry_msgs/msg/Quaternion"](
            x=0.0, y=0.0, z=float(np.sin(yaw / 2)), w=float(np.cos(yaw / 2))
        )
        imu = kinds["sensor_msgs/msg/Imu"](
            header=header(time),
            orientation=turned,
            orientation_covariance=zero,
            angular_velocity=vector(x=0.0, y=0.0, z=-float(fast["yaw_rate"][i])),
            angular_velocity_covariance=zero,
            linear_acceleration=vector(x=0.0, y=0.0, z=0.0),
            linear_acceleration_covariance=zero,
        )
        made.append((time, "/imu", imu))
    made = [entry for entry in made if entry[1] in topics]
    with Writer(path) as writer:
        opened = {
            name: writer.add_connection(name, one.__msgtype__, typestore=store)
            for name, one in {name: one for _, name, one in made}.items()
        }
        for time, name, one in sorted(made, key=lambda entry: entry[0]):
            stamp = round(1e9 * (1_700_000_000.0 + time))
            writer.write(opened[name], stamp, store.serialize_ros1(one, one.__msgtype__))
    return path


def bag_without_definitions(folder: Path) -> Path:
    """A bag as ROS 2 Humble records it: mavros's RCOut and a message of an own package, undefined."""
    import sqlite3

    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store: Any = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg("std_msgs/Header header\nuint16[] channels\n", "mavros_msgs/msg/RCOut"))
    store.register(get_types_from_msg("float64 level\n", "tank_msgs/msg/Level"))
    kinds = store.types
    header = kinds["std_msgs/msg/Header"](
        stamp=kinds["builtin_interfaces/msg/Time"](sec=1_700_000_000, nanosec=0), frame_id=""
    )
    pulses = kinds["mavros_msgs/msg/RCOut"](header=header, channels=np.array([1500, 1900], np.uint16))
    messages = {"/rc": pulses, "/tank": kinds["tank_msgs/msg/Level"](level=1.0)}
    with Writer(folder, version=8) as writer:
        for topic, message in messages.items():
            own = writer.add_connection(topic, message.__msgtype__, typestore=store)
            writer.write(own, 1_700_000_000 * 10**9, store.serialize_cdr(message, message.__msgtype__))
    (held,) = folder.glob("*.db3")
    with sqlite3.connect(held) as file:
        file.execute("DROP TABLE message_definitions")
        file.execute("UPDATE schema SET schema_version = 3")
    metadata = folder / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("version: 8", "version: 5"))
    return folder
