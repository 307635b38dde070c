"""The mapping of a binary log where none is given: what its recorder usually calls our columns."""

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from swamp_rl.boat import Boat
from swamp_rl.logs.expression import names_in, parsed
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapping import Frame
from swamp_rl.logs.mapping import Mapping as LogMapping

Expressions = Mapping[str, str]


@dataclass(frozen=True)
class Source:
    """Columns of a run from one message: taken where the log has all that the expressions read. `gives`: the
    columns of a run, of which each is taken from the first source that has it."""

    message: str
    gives: str
    columns: Expressions


DATAFLASH = (
    Source("GPS", "position", {"latitude": "GPS.Lat", "longitude": "GPS.Lng"}),
    Source("POS", "position", {"latitude": "POS.Lat", "longitude": "POS.Lng"}),
    Source("XKF1", "position", {"north": "XKF1.PN", "east": "XKF1.PE"}),
    Source("ATT", "heading", {"yaw": "radians(ATT.Yaw)"}),
    Source("XKF1", "heading", {"yaw": "radians(XKF1.Yaw)"}),
    Source(
        "GPS",
        "velocity",
        {
            "velocity_north": "GPS.Spd * cos(radians(GPS.GCrs))",
            "velocity_east": "GPS.Spd * sin(radians(GPS.GCrs))",
        },
    ),
    Source("XKF1", "velocity", {"velocity_north": "XKF1.VN", "velocity_east": "XKF1.VE"}),
    Source("IMU", "yaw rate", {"yaw_rate": "IMU.GyrZ"}),
)
ULOG = (
    Source(
        "vehicle_local_position",
        "position",
        {"x": "vehicle_local_position.x", "y": "vehicle_local_position.y"},
    ),
    Source(
        "vehicle_gps_position",
        "position",
        {"latitude": "vehicle_gps_position.latitude_deg", "longitude": "vehicle_gps_position.longitude_deg"},
    ),
    Source(
        "vehicle_gps_position",
        "position",
        {"latitude": "vehicle_gps_position.lat * 1e-7", "longitude": "vehicle_gps_position.lon * 1e-7"},
    ),
    Source(
        "vehicle_attitude",
        "heading",
        {f"q{axis}": f"vehicle_attitude.q[{i}]" for i, axis in enumerate("wxyz")},
    ),
    Source("vehicle_local_position", "heading", {"yaw": "vehicle_local_position.heading"}),
    Source(
        "vehicle_local_position",
        "velocity",
        {"vx": "vehicle_local_position.vx", "vy": "vehicle_local_position.vy"},
    ),
    Source("vehicle_angular_velocity", "yaw rate", {"r": "vehicle_angular_velocity.xyz[2]"}),
)
TWIST = {
    "u": "TABLE.twist.twist.linear.x",
    "v": "TABLE.twist.twist.linear.y",
    "r": "TABLE.twist.twist.angular.z",
}
ROS = (
    Source("nav_msgs/Odometry", "position", {a: f"TABLE.pose.pose.position.{a}" for a in "xy"}),
    Source("nav_msgs/Odometry", "heading", {f"q{a}": f"TABLE.pose.pose.orientation.{a}" for a in "wxyz"}),
    Source("nav_msgs/Odometry", "velocity", {name: TWIST[name] for name in "uv"}),
    Source("nav_msgs/Odometry", "yaw rate", {"r": TWIST["r"]}),
    Source(
        "sensor_msgs/NavSatFix", "position", {"latitude": "TABLE.latitude", "longitude": "TABLE.longitude"}
    ),
    Source("sensor_msgs/Imu", "heading", {f"q{a}": f"TABLE.orientation.{a}" for a in "wxyz"}),
    Source("sensor_msgs/Imu", "yaw rate", {"r": "TABLE.angular_velocity.z"}),
    Source(
        "geometry_msgs/TwistStamped", "velocity", {"u": "TABLE.twist.linear.x", "v": "TABLE.twist.linear.y"}
    ),
    Source("geometry_msgs/TwistStamped", "yaw rate", {"r": "TABLE.twist.angular.z"}),
)
NUMBERS = ("std_msgs/Float32", "std_msgs/Float64")
SOURCES = {"dataflash": DATAFLASH, "ulog": ULOG, "rosbag": ROS}
FRAMES: dict[str, Frame] = {"dataflash": "ned", "ulog": "ned", "rosbag": "enu"}
SERVO_SIDES = {73.0: "left", 74.0: "right"}
"""ArduPilot's SERVOn_FUNCTION of skid steering: ThrottleLeft and ThrottleRight."""
LEFT, RIGHT = re.compile("left|port"), re.compile("right|starboard")


def wanted_messages(kind: str, mapping: LogMapping) -> set[str]:
    """Names of the tables that the default mapping or a given one may read."""
    named = {name.partition(".")[0] for node in mapping.columns.values() for name in names_in(node)}
    for pair in mapping.clock:
        named |= {
            word.partition(".")[0] for part in pair.split("~") for word in names_in(parsed(part.strip()))
        }
    own = {source.message for source in SOURCES[kind]} if kind != "rosbag" else set()
    return named | own | ({"RCOU", "PARM"} if kind == "dataflash" else set())


def ros_kinds() -> Collection[str]:
    """Message types that the default mapping reads."""
    return {source.message for source in ROS} | set(NUMBERS)


def default_mapping(kind: str, log: Log, given: LogMapping, boat: Boat) -> LogMapping:
    """The default mapping of what the log has and the given one does not, in the frame of the format."""
    columns: dict[str, str] = {}
    taken: set[str] = set()
    for source in SOURCES[kind]:
        for table in log.tables.values():
            if (table.kind if kind == "rosbag" else table.name) != source.message or source.gives in taken:
                continue
            told = {name: text.replace("TABLE", table.name) for name, text in source.columns.items()}
            fields = {name for text in told.values() for name in names_in(parsed(text))}
            if (
                all(name.partition(".")[2] in table.table.columns for name in fields)
                and len(table.table.rows) > 1
            ):
                columns |= told
                taken.add(source.gives)
    columns = {name: text for name, text in columns.items() if not _replaced(name, given.columns)}
    columns |= {name: text for name, text in _commands(kind, log, boat).items() if name not in given.columns}
    return LogMapping({name: parsed(text) for name, text in columns.items()}, frame=FRAMES[kind])


GROUPS = (
    {"latitude", "longitude", "north", "east", "x", "y"},
    {"heading", "yaw", "qw", "qx", "qy", "qz"},
    {"surge", "sway", "u", "v", "vx", "vy", "velocity_north", "velocity_east"},
    {"yaw_rate", "r"},
)


def _replaced(name: str, given: Collection[str]) -> bool:
    """Whether the given mapping has another source of the same columns."""
    return any(name in group and group & set(given) for group in GROUPS)


def _commands(kind: str, log: Log, boat: Boat) -> dict[str, str]:
    """Levels of thrusters whose place in the log is certain: by ArduPilot's functions of its outputs, or by
    topics of single numbers that bear the thruster's name."""
    sides = {thruster.name: thruster.y for thruster in boat.thrusters if thruster.kind == "fixed"}
    if kind == "dataflash" and len(sides) == 2:
        return _servos(log, sides)
    if kind == "rosbag":
        return _topics(log, boat)
    return {}


def _servos(log: Log, sides: Mapping[str, float]) -> dict[str, str]:
    found = {}
    outputs = log.tables.get("RCOU")
    for number in range(1, 15):
        side = SERVO_SIDES.get(_parameter(log, f"SERVO{number}_FUNCTION", 0.0))
        names = [name for name, y in sides.items() if y != 0.0 and (y < 0.0) == (side == "left")]
        if side and outputs and len(names) == 1 and f"C{number}" in outputs.table.columns:
            low, high, trim, reversed_ = (
                _parameter(log, f"SERVO{number}_{name}", usual)
                for name, usual in (("MIN", 1100.0), ("MAX", 1900.0), ("TRIM", 1500.0), ("REVERSED", 0.0))
            )
            if low < trim < high:
                sign = "-" if reversed_ else ""
                pulse = f"(RCOU.C{number} - {trim:g})"
                share = f"where({pulse} > 0, {pulse} / {high - trim:g}, {pulse} / {trim - low:g})"
                text = f"{sign}clip({share}, -1, 1)"
                found[f"throttle_{names[0]}"] = text
    return found if len(found) == 2 else {}


def _parameter(log: Log, name: str, usual: float) -> float:
    """A parameter's value; the usual one where the log has none that is a finite number."""
    try:
        value = float(log.told.get(f"parameter {name}", usual))
    except ValueError:
        return usual
    return value if math.isfinite(value) else usual


def _topics(log: Log, boat: Boat) -> dict[str, str]:
    found = {}
    for thruster in boat.thrusters:
        for column in filter(None, thruster.command_columns):
            kind, _, name = column.partition("_")
            words = [
                table.name
                for table in log.tables.values()
                if table.kind in NUMBERS and name in re.split(r"[_/]", table.name.lower())
            ]
            exact = [word for word in words if kind in word.lower()] or (words if kind != "azimuth" else [])
            if len(exact) == 1:
                found[column] = f"{exact[0]}.data"
    names = {column for t in boat.thrusters for column in t.command_columns if column is not None}
    return found if set(found) == names else {}
