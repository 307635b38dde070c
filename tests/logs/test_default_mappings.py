"""Default mappings where messages of a binary log are invalid, and of commands by the log's parameters."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.logs.default_commands import commands
from swamp_rl.logs.defaults import default_mapping
from swamp_rl.logs.expression import evaluated, names_in, parsed
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.mapping import Mapping
from swamp_rl.runs.table import Table
from tests.support.from_scratch import written

POSE = "geometry_msgs/Pose2D"
POSITION = {"x": [1.0, 2.0, 3.0, 4.0], "y": [0.0] * 4}
FIX = {"lat": [5e8, 5e8, 5e8 + 10, 5e8 + 20], "lon": [1e8] * 4, "fix_type": [0.0, 3.0, 3.0, 3.0]}


def log_of(tables: dict[str, dict[str, list[float]]], parameters: dict[str, float] | None = None) -> Log:
    made = {}
    for name, columns in tables.items():
        arrays = {field: np.array(values, float) for field, values in columns.items()}
        rows = np.arange(1, 1 + len(next(iter(arrays.values()))))
        made[name] = LogTable(name, Table(arrays, rows), 0.1 * rows)
    return Log("log", "log", made, {f"parameter {n}": str(value) for n, value in (parameters or {}).items()})


def values_of(log: Log, text: str) -> list[float]:
    node = parsed(text)
    there = {name: log.tables[(at := name.partition("."))[0]].table.columns[at[2]] for name in names_in(node)}
    return np.broadcast_to(evaluated(node, there), (4,)).tolist()


def mapped_by_default(log: Log, kind: str = "ulog") -> Mapping:
    return default_mapping(kind, log, Mapping(), load_boat("swamp"))


def test_a_position_that_px4_never_calls_valid_gives_way_to_the_receiver() -> None:
    tables = {"vehicle_local_position": POSITION | {"xy_valid": [0.0] * 4}, "vehicle_gps_position": FIX}
    found = mapped_by_default(log_of(tables)).columns
    assert "latitude" in found and "x" not in found
    tables["vehicle_local_position"]["xy_valid"] = [0.0, 1.0, 1.0, 1.0]
    assert "x" in mapped_by_default(log_of(tables)).columns


def test_rows_without_a_fix_have_no_position() -> None:
    receiver = {"Lat": [0.0, 45.0, 45.0, 45.0], "Lng": [9.0] * 4, "Status": [1.0, 3.0, 4.0, 6.0]}
    log = log_of({"GPS": receiver})
    node = mapped_by_default(log, "dataflash").columns["latitude"]
    columns = {f"GPS.{name}": np.array(values) for name, values in receiver.items()}
    assert np.isfinite(evaluated(node, columns)).tolist() == [False, True, True, True]


def test_an_imu_of_ros_that_disclaims_its_orientation_gives_no_heading() -> None:
    """Element 0 of a covariance is -1 where a sensor has no such estimate (sensor_msgs/Imu)."""
    turned = {f"orientation.{axis}": [float(axis == "w")] * 4 for axis in "wxyz"}
    rates = {"angular_velocity.z": [0.1, 0.2, 0.3, 0.4], "angular_velocity_covariance[0]": [0.0] * 4}
    columns = {name: np.array(values) for name, values in (turned | rates).items()}
    for known, names in ((0.0, {"qw", "qx", "qy", "qz", "r"}), (-1.0, {"r"})):
        table = Table(columns | {"orientation_covariance[0]": np.full(4, known)}, np.arange(1, 5))
        log = Log("log", "log", {"imu": LogTable("imu", table, np.arange(4.0), "sensor_msgs/Imu")})
        assert set(mapped_by_default(log, "rosbag").columns) == names


@pytest.mark.parametrize("name", ["XKF1", "NKF1", "EKF1"])
def test_any_generation_of_ardupilots_filter_gives_the_position(name: str) -> None:
    filter_ = {
        "PN": [0.0, 1.0, 2.0, 3.0],
        "PE": [0.0] * 4,
        "Yaw": [90.0] * 4,
        "VN": [1.0] * 4,
        "VE": [0.0] * 4,
    }
    found = mapped_by_default(
        log_of({name: filter_, "AHR2": {"Lat": [0.0] * 4, "Lng": [0.0] * 4}}), "dataflash"
    )
    assert set(found.columns) == {"north", "east", "yaw", "velocity_north", "velocity_east"}


def test_px4s_first_motor_is_the_one_to_starboard_unless_its_place_says_otherwise(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    motors = {"control[0]": [0.1, 0.2, np.nan, 0.4], "control[1]": [-0.1, 0.0, np.nan, 0.2]}
    log = log_of({"actuator_motors": motors})
    found = commands("ulog", log, boat)
    assert values_of(log, found["throttle_starboard"]) == [0.1, 0.2, 0.0, 0.4]
    assert values_of(log, found["throttle_port"]) == [-0.1, 0.0, 0.0, 0.2]
    other = log_of({"actuator_motors": motors}, {"CA_ROTOR0_PY": -0.5, "CA_ROTOR1_PY": 0.5})
    assert values_of(other, commands("ulog", other, boat)["throttle_port"]) == [0.1, 0.2, 0.0, 0.4]


def test_px4s_pulses_are_shares_between_their_limits(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    pulses = {
        "output[0]": [1000.0] * 4,
        "output[3]": [1100.0, 1500.0, 1700.0, 1900.0],
        "output[4]": [1500.0] * 4,
    }
    limits = {f"PWM_MAIN_{end}{n}": value for n in (4, 5) for end, value in (("MIN", 1100), ("MAX", 1900))}
    log = log_of(
        {"actuator_outputs": pulses}, {"PWM_MAIN_FUNC4": 102, "PWM_MAIN_FUNC5": 101, "CA_R_REV": 3} | limits
    )
    found = commands("ulog", log, boat)
    assert values_of(log, found["throttle_port"]) == pytest.approx([-1.0, 0.0, 0.5, 1.0])
    assert values_of(log, found["throttle_starboard"]) == [0.0] * 4


@pytest.mark.parametrize("reversed_", [0, 1])
def test_an_output_without_a_pulse_is_a_thruster_at_rest(tmp_path: Path, reversed_: int) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    outputs = {"C1": [0.0, 1100.0, 1500.0, 1900.0], "C3": [0.0, 800.0, 1095.0, 1500.0]}
    functions = {"SERVO1_FUNCTION": 73, "SERVO3_FUNCTION": 74, "SERVO1_REVERSED": reversed_}
    log = log_of({"RCOU": outputs}, functions)
    found = commands("dataflash", log, boat)
    ahead = -1.0 if reversed_ else 1.0
    assert values_of(log, found["throttle_port"]) == [0.0, -ahead, 0.0, ahead]
    assert values_of(log, found["throttle_starboard"]) == [0.0, 0.0, -1.0, 0.0]


def test_px4s_pulse_of_a_disarmed_boat_is_a_thruster_at_rest(tmp_path: Path) -> None:
    functions = {"PWM_MAIN_FUNC1": 101, "PWM_MAIN_FUNC2": 102, "CA_R_REV": 3}
    limits = {f"PWM_MAIN_{end}{n}": value for n in (1, 2) for end, value in (("MIN", 1100), ("MAX", 1900))}
    pulses = {f"output[{i}]": [900.0, 1000.0, 1100.0, 1700.0] for i in (0, 1)}
    log = log_of({"actuator_outputs": pulses}, functions | limits)
    found = commands("ulog", log, load_boat(written(tmp_path, "twin")))
    assert values_of(log, found["throttle_port"]) == [0.0, 0.0, -1.0, 0.5]


def test_a_propeller_and_its_rudder_take_motor_and_servo() -> None:
    boat = load_boat("esso_osaka")
    (only,) = boat.thrusters
    turn, level = only.command_columns
    log = log_of(
        {
            "actuator_motors": {"control[0]": [0.0, 0.5, 1.0, 1.0]},
            "actuator_servos": {"control[0]": [-1.0, 0.0, 0.5, 1.0]},
        }
    )
    found = commands("ulog", log, boat)
    assert turn is not None
    assert values_of(log, found[level]) == pytest.approx(
        [0.0, 0.5 * only.throttle_max, *[only.throttle_max] * 2]
    )
    assert values_of(log, found[turn])[0] == pytest.approx(-values_of(log, found[turn])[3])
    outputs = {"C1": [1100.0, 1500.0, 1700.0, 1900.0], "C3": [1100.0, 1100.0, 1500.0, 1900.0]}
    old = log_of({"RCOU": outputs}, {"SERVO1_FUNCTION": 26, "SERVO3_FUNCTION": 70, "SERVO3_TRIM": 1100})
    found = commands("dataflash", old, boat)
    assert values_of(old, found[level]) == pytest.approx(
        [0.0, 0.0, 0.5 * only.throttle_max, only.throttle_max]
    )
    assert values_of(old, found[turn])[2] == pytest.approx(0.5 * values_of(old, found[turn])[3])


def test_the_pilots_levers_are_kept_where_no_actuator_is_certain() -> None:
    log = log_of({"manual_control_setpoint": {"z": [0.0, 0.2, 0.4, 0.6], "r": [0.0, -0.5, 0.5, 1.0]}})
    found = commands("ulog", log, load_boat("swamp"))
    assert values_of(log, found["joy_thrust"]) == [0.0, 0.2, 0.4, 0.6]
    assert values_of(log, found["joy_angle"]) == [0.0, -0.5, 0.5, 1.0]


def test_of_several_poses_in_the_plane_none_is_taken() -> None:
    """A controller's output and a set point are of the same type as the position."""
    pose = {"x": np.array([0.0, 1.0, 2.0]), "y": np.zeros(3), "theta": np.zeros(3)}

    def log(*names: str) -> Log:
        tables = {n: LogTable(n, Table(pose, np.arange(1, 4)), np.arange(3.0), POSE) for n in names}
        return Log("trip.bag", "trip", tables)

    assert set(mapped_by_default(log("ins"), "rosbag").columns) == {"x", "y", "yaw"}
    with pytest.raises(
        UserError, match=r"position may be that of 2 topics .*\(input, ins\).* --map x=TOPIC.x"
    ):
        mapped_by_default(log("input", "ins"), "rosbag")
    given = Mapping({name: parsed(f"ins.{name}") for name in "xy"})
    with pytest.raises(UserError, match=r"heading may be that of 2 topics .* --map yaw=TOPIC.theta"):
        default_mapping("rosbag", log("input", "ins"), given, load_boat("swamp"))
    given = Mapping(dict(given.columns) | {"yaw": parsed("ins.theta")})
    assert default_mapping("rosbag", log("input", "ins"), given, load_boat("swamp")).columns == {}
