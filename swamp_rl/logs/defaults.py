"""The mapping of a binary log where none is given: what its recorder usually calls our columns."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.logs.default_commands import MESSAGES, NUMBERS, commands
from swamp_rl.logs.expression import evaluated, names_in, parsed
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.mapping import Frame
from swamp_rl.logs.mapping import Mapping as LogMapping

Expressions = Mapping[str, str]


@dataclass(frozen=True)
class Source:
    """Columns of a run from one message: taken where the log has numbers for all of the expressions. `gives`:
    the columns of a run, of which each is taken from the first source that has it; `valid`: the rows whose
    numbers count, where the log has the fields that it reads."""

    message: str
    gives: str
    columns: Expressions
    valid: str = ""


RECEIVERS = (("GPS", "GPS.Status >= 3"), ("GPS2", "GPS2.Status >= 3"), ("GPS_1", "GPS_1.Status >= 3"))
FILTERS = ("XKF1", "NKF1", "EKF1")
"""Messages of ArduPilot's Kalman filters: the third, the second since 2016, the first."""
DATAFLASH = (
    *(
        Source(receiver, "position", {"latitude": f"{receiver}.Lat", "longitude": f"{receiver}.Lng"}, fix)
        for receiver, fix in RECEIVERS
    ),
    Source("POS", "position", {"latitude": "POS.Lat", "longitude": "POS.Lng"}, "abs(POS.Lat) > 0"),
    *(Source(name, "position", {"north": f"{name}.PN", "east": f"{name}.PE"}) for name in FILTERS),
    Source("AHR2", "position", {"latitude": "AHR2.Lat", "longitude": "AHR2.Lng"}, "abs(AHR2.Lat) > 0"),
    *(Source(name, "heading", {"yaw": f"radians({name}.Yaw)"}) for name in ("ATT", *FILTERS, "AHR2")),
    *(
        Source(
            receiver,
            "velocity",
            {
                "velocity_north": f"{receiver}.Spd * cos(radians({receiver}.GCrs))",
                "velocity_east": f"{receiver}.Spd * sin(radians({receiver}.GCrs))",
            },
            fix,
        )
        for receiver, fix in RECEIVERS
    ),
    *(
        Source(name, "velocity", {"velocity_north": f"{name}.VN", "velocity_east": f"{name}.VE"})
        for name in FILTERS
    ),
    *(Source(name, "yaw rate", {"yaw_rate": f"{name}.GyrZ"}) for name in ("IMU", "IMU_1")),
)
ULOG = (
    Source(
        "vehicle_local_position",
        "position",
        {"x": "vehicle_local_position.x", "y": "vehicle_local_position.y"},
        "vehicle_local_position.xy_valid > 0",
    ),
    Source(
        "vehicle_gps_position",
        "position",
        {"latitude": "vehicle_gps_position.latitude_deg", "longitude": "vehicle_gps_position.longitude_deg"},
        "vehicle_gps_position.fix_type >= 3",
    ),
    Source(
        "vehicle_gps_position",
        "position",
        {"latitude": "vehicle_gps_position.lat * 1e-7", "longitude": "vehicle_gps_position.lon * 1e-7"},
        "vehicle_gps_position.fix_type >= 3",
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
        "vehicle_local_position.v_xy_valid > 0",
    ),
    Source(
        "vehicle_gps_position",
        "velocity",
        {"vx": "vehicle_gps_position.vel_n_m_s", "vy": "vehicle_gps_position.vel_e_m_s"},
        "vehicle_gps_position.fix_type >= 3",
    ),
    Source("vehicle_angular_velocity", "yaw rate", {"r": "vehicle_angular_velocity.xyz[2]"}),
    Source("vehicle_attitude", "yaw rate", {"r": "vehicle_attitude.yawspeed"}),
    Source("sensor_combined", "yaw rate", {"r": "sensor_combined.gyro_rad[2]"}),
)
POSE_2D = "geometry_msgs/Pose2D"
"""Of positions, set points and controllers' outputs alike: of several no one is taken."""
POSES = {"geometry_msgs/PoseStamped": "pose", "geometry_msgs/PoseWithCovarianceStamped": "pose.pose"}
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
        "sensor_msgs/NavSatFix",
        "position",
        {"latitude": "TABLE.latitude", "longitude": "TABLE.longitude"},
        "TABLE.status.status >= 0",
    ),
    *(
        Source(kind, "position", {a: f"TABLE.{pose}.position.{a}" for a in "xy"})
        for kind, pose in POSES.items()
    ),
    Source(POSE_2D, "position", {a: f"TABLE.{a}" for a in "xy"}),
    *(
        Source(kind, "heading", {f"q{a}": f"TABLE.{pose}.orientation.{a}" for a in "wxyz"})
        for kind, pose in POSES.items()
    ),
    Source(POSE_2D, "heading", {"yaw": "TABLE.theta"}),
    Source(
        "sensor_msgs/Imu",
        "heading",
        {f"q{a}": f"TABLE.orientation.{a}" for a in "wxyz"},
        "TABLE.orientation_covariance[0] >= 0",
    ),
    Source(
        "sensor_msgs/Imu",
        "yaw rate",
        {"r": "TABLE.angular_velocity.z"},
        "TABLE.angular_velocity_covariance[0] >= 0",
    ),
    Source(
        "geometry_msgs/TwistStamped", "velocity", {"u": "TABLE.twist.linear.x", "v": "TABLE.twist.linear.y"}
    ),
    Source("geometry_msgs/TwistStamped", "yaw rate", {"r": "TABLE.twist.angular.z"}),
)
SOURCES = {"dataflash": DATAFLASH, "ulog": ULOG, "rosbag": ROS}
FRAMES: dict[str, Frame] = {"dataflash": "ned", "ulog": "ned", "rosbag": "enu"}


def wanted_messages(kind: str, mapping: LogMapping) -> set[str]:
    """Names of the tables that the default mapping or a given one may read."""
    named = {name.partition(".")[0] for name in mapping.names}
    own = {source.message for source in SOURCES[kind]} if kind != "rosbag" else set()
    return named | own | set(MESSAGES[kind])


def ros_kinds() -> Collection[str]:
    """Message types that the default mapping reads."""
    return {source.message for source in ROS} | set(NUMBERS)


def default_mapping(kind: str, log: Log, given: LogMapping, boat: Boat) -> LogMapping:
    """The default mapping of what the log has and the given one does not, in the frame of the format.

    UserError where a quantity is of several messages of POSE_2D alone.
    """
    columns = default_columns(kind, log, given, boat)
    return LogMapping({name: parsed(text) for name, text in columns.items()}, frame=FRAMES[kind])


def default_columns(kind: str, log: Log, given: LogMapping, boat: Boat) -> dict[str, str]:
    """The expressions of `default_mapping` by what they give."""
    columns: dict[str, str] = {}
    taken: set[str] = set()
    for source in SOURCES[kind]:
        if source.gives in taken or all(replaced(name, given.columns) for name in source.columns):
            continue
        fitting = {}
        for table in log.tables.values():
            if (table.kind if kind == "rosbag" else table.name) == source.message:
                own = {name: _where_valid(table, source, text) for name, text in source.columns.items()}
                if all(_has_numbers(table, text) for text in own.values()):
                    fitting[table.name] = own
        if fitting:
            if source.message == POSE_2D and len(fitting) > 1:
                raise UserError(_several(log, source, sorted(fitting)))
            columns |= next(iter(fitting.values()))
            taken.add(source.gives)
    columns = {name: text for name, text in columns.items() if not replaced(name, given.columns)}
    commanded = commands(kind, log, boat)
    return columns | {name: text for name, text in commanded.items() if name not in given.columns}


def _several(log: Log, source: Source, tables: list[str]) -> str:
    """What to say where several messages of one type may be what a source gives."""
    options = " ".join(
        f"--map {name}={text.replace('TABLE', 'TOPIC')}" for name, text in source.columns.items()
    )
    return (
        f"{log.file}: the {source.gives} may be that of {len(tables)} topics of {source.message} "
        f"({clipped(', '.join(tables), 400)}); give {options} with one of them"
    )


def _where_valid(table: LogTable, source: Source, text: str) -> str:
    """The expression of a table, missing where the message says that it is not valid."""
    text = text.replace("TABLE", table.name)
    valid = source.valid.replace("TABLE", table.name)
    fields = names_in(parsed(valid)) if valid else iter(())
    known = [name.partition(".")[2] in table.table.columns for name in fields]
    return f"where({valid}, {text}, 0/0)" if known and all(known) else text


def _has_numbers(table: LogTable, text: str) -> bool:
    """Whether the table has the expression's fields, with more than one number."""
    node = parsed(text)
    columns = {name: table.table.columns.get(name.partition(".")[2]) for name in names_in(node)}
    there = {name: values for name, values in columns.items() if values is not None}
    return len(there) == len(columns) and int(np.isfinite(evaluated(node, there)).sum()) > 1


VELOCITY = {"surge", "sway", "u", "v", "vx", "vy", "velocity_north", "velocity_east"}
ALTERNATIVES = (
    {"latitude", "longitude", "north", "east", "x", "y"},
    {"heading", "yaw", "qw", "qx", "qy", "qz"},
    VELOCITY,
    {"yaw_rate", "r"},
)
"""Sources of the same columns."""


def replaced(name: str, given: Collection[str]) -> bool:
    """Whether the given mapping has another source of the same columns."""
    return any(name in group and group & set(given) for group in ALTERNATIVES)
