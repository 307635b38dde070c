"""Options of an import that the names of columns suggest."""

import shlex
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.cli import app as cli

from swamp_rl.boat import PropellerRudder, load_boat
from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.proposal import proposal, taken_by_default
from swamp_rl.runs import read_dataset
from swamp_rl.runs.table import Table
from tests.support.binary_logs import bag
from tests.support.from_scratch import written
from tests.support.logs import csv_of, weaving
from tests.support.new_boats import file_of

Call = Callable[..., str]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    monkeypatch.chdir(tmp_path)

    def called(*words: object) -> str:
        monkeypatch.setattr(sys, "argv", ["swamp-rl", "runs", "import", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        assert not stop.value.code
        return capsys.readouterr().out

    return called


def log_of(**tables: list[str]) -> Log:
    rows = np.arange(1, 4)
    there = {
        name: LogTable(name, Table({column: np.zeros(3) for column in columns}, rows))
        for name, columns in tables.items()
    }
    return Log("day.csv", "day", there)


def suggested(boat: str, log: Log) -> tuple[dict[str, str], list[str]]:
    """The words after `--map` and `--unit` by our names, and the names that are not found."""
    options, *missing = proposal(log, load_boat(boat))
    words = shlex.split(options.partition(": ")[2])
    pairs = [word.partition("=") for word in words if not word.startswith("--")]
    found: dict[str, str] = {}
    for name, _, value in pairs:
        found[name] = f"{found[name]} [{value}]" if name in found else value
    return found, [name for line in missing for name in line.partition(": ")[2].split(", ")]


def test_the_import_that_names_suggest_is_that_of_what_was_logged(call: Call, tmp_path: Path) -> None:
    was, boat = weaving(), written(tmp_path, "twin")
    columns = {
        "Time (s)": was["time"],
        "pos_n": was["north"],
        "pos_e": was["east"],
        "Yaw [deg]": np.degrees(was["heading"]),
        "speed kn": was["surge"],
        "Motor Left %": 100.0 * was["throttle_port"],
        "motor_right_pct": 100.0 * was["throttle_starboard"],
    }
    log = csv_of(tmp_path / "log.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})
    *_, line = call(log, "--list", "--boat", boat).splitlines()
    assert line.startswith("by their names, to be checked: --map ")
    call(log, "--boat", boat, "--out", "out", *shlex.split(line.partition(": ")[2]))
    (run,) = read_dataset(tmp_path / "out").runs
    for name in ("time", "north", "east", "heading", "throttle_port", "throttle_starboard"):
        np.testing.assert_allclose(run.columns[name], was[name], atol=1e-9, err_msg=name)


def test_percentages_of_a_propeller_and_its_rudder_are_of_the_limits(call: Call, tmp_path: Path) -> None:
    boat, was = load_boat("esso_osaka"), weaving()
    columns = {
        "t": was["time"],
        "north": was["north"],
        "east": was["east"],
        "heading_deg": np.degrees(was["heading"]),
        "throttle_pct": 100.0 * was["throttle_port"],
        "rudder %": 100.0 * np.sin(was["time"]),
    }
    log = csv_of(tmp_path / "log.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})
    *_, line = call(log, "--list", "--boat", "esso_osaka").splitlines()
    call(log, "--boat", "esso_osaka", "--out", "out", *shlex.split(line.partition(": ")[2]))
    (run,) = read_dataset(tmp_path / "out").runs
    (main,) = boat.thrusters
    assert isinstance(main, PropellerRudder)
    revolutions, angle = main.throttle_max * was["throttle_port"], main.rudder_max * np.sin(was["time"])
    np.testing.assert_allclose(run.columns["propeller_main"], revolutions)
    np.testing.assert_allclose(run.columns["rudder_main"], angle, atol=1e-9)


def test_columns_of_several_tables_are_named_with_their_table() -> None:
    ahrs = ["ts", "roll_deg", "yaw_deg", "ve_mps", "vn_mps", "omega_z_dps"]
    found, missing = suggested("swamp", log_of(ahrs=ahrs, control=["ts", "throttle", "turn"]))
    assert found == {
        "time": "ts",
        "heading": "ahrs.yaw_deg [deg]",
        "velocity_north": "ahrs.vn_mps",
        "velocity_east": "ahrs.ve_mps",
        "yaw_rate": "ahrs.omega_z_dps [deg/s]",
    }
    assert missing[:3] == ["north", "east", "azimuth_bs"]


def test_tables_with_times_of_other_names_have_one_each() -> None:
    found, missing = suggested("swamp", log_of(gps=["t_ms", "lat", "lon"], motor=["Zeit UTC"]))
    assert found == {"time": "t_ms [ms]", "latitude": "gps.lat", "longitude": "gps.lon"}
    found, missing = suggested("swamp", log_of(gps=["t_ms", "lat", "lon"], motor=["stamp", "rpm"]))
    assert (found["gps.time"], found["motor.time"]) == ("t_ms [ms]", "stamp") and "time" not in missing


@pytest.mark.parametrize(
    ("columns", "found"),
    [
        (["epoch_ms", "lat", "lon"], {"time": "epoch_ms [ms]", "latitude": "lat", "longitude": "lon"}),
        (["utcTime", "GPS Latitude", "gps_lng"], {"latitude": "`GPS Latitude`", "longitude": "gps_lng"}),
        (["t", "lat", "lon", "x", "y"], {"time": "t", "latitude": "lat", "longitude": "lon"}),
        (["t", "n", "rudder_deg", "rpm"], {"time": "t", "rudder_main": "rudder_deg [deg]"}),
        (["t", "x", "vx", "yaw_rate_deg_s"], {"time": "t", "yaw_rate": "yaw_rate_deg_s [deg/s]"}),
        (["t", "vn_ms", "veMs"], {"time": "t", "velocity_north": "vn_ms", "velocity_east": "veMs"}),
        (["heading_setpoint", "cog", "roll"], None),
        (["time\x1b[", "ti`me", f"time{' ' * 200}", "yaw\n"], None),
    ],
)
def test_only_names_that_are_clear_are_suggested(columns: list[str], found: dict[str, str] | None) -> None:
    log = log_of(day=columns)
    if found is None:
        assert proposal(log, load_boat("esso_osaka")) == []
    else:
        assert {name: one for name, one in suggested("esso_osaka", log)[0].items() if name in found} == found
        assert suggested("esso_osaka", log)[0].keys() - found.keys() <= {"time"}


def test_a_command_of_one_of_several_thrusters_is_not_guessed(tmp_path: Path) -> None:
    boat = str(written(tmp_path, "twin"))
    assert suggested(boat, log_of(day=["t", "throttle"]))[0] == {"time": "t"}
    assert "throttle_port" in suggested(boat, log_of(day=["t", "throttle"]))[1]


def test_logs_with_other_columns_have_no_common_options(call: Call, tmp_path: Path) -> None:
    logs = [csv_of(tmp_path / f"{name}.csv", {name: ["0.0", "1.0"]}) for name in ("t", "ts")]
    assert "by their names" not in call(*logs, "--list")
    for log in logs:
        assert "by their names, to be checked: --map time=" in call(log, "--list")
    assert "differ in their columns: --list one at a time" in call(*logs, "--list")
    again = tmp_path / "again" / "other.csv"
    again.parent.mkdir()
    again.write_bytes(logs[0].read_bytes())
    assert call(logs[0], again, "--list").count("by their names") == 1


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (4959442.825 + 100.0 * np.arange(3), "original_timestamp [ms]"),
        (1e6 + 1e5 * np.arange(3), "original_timestamp [us]"),
        (1e9 + 1e8 * np.arange(3), "original_timestamp [ns]"),
        (0.1 * np.arange(3), "original_timestamp"),
        (1.7e12 + 100.0 * np.arange(3), "original_timestamp"),  # since 1970, which an import knows
    ],
)
def test_the_unit_of_times_without_one_is_that_of_their_steps(times: np.ndarray, said: str) -> None:
    table = Table({"original_timestamp": times, "lat": np.zeros(3)}, np.arange(1, 4))
    found, missing = suggested("swamp", Log("day.csv", "day", {"day": LogTable("day", table)}))
    assert found["time"] == said and "time" not in missing


def test_a_table_of_other_things_does_not_hide_the_options_of_the_logs(call: Call, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    for name in ("one", "two"):
        csv_of(tmp_path / "logs" / f"{name}.csv", {"t": ["0.0", "1.0"], "lat": ["44.0", "44.1"]})
    csv_of(tmp_path / "logs" / "notes.csv", {"id": ["1", "2"]})
    said = call(tmp_path / "logs", "--list")
    assert said.count("by their names, to be checked: --map time=t") == 1
    assert said.splitlines()[-1].startswith("no column known by name: notes;")


def test_logs_of_the_same_fields_are_listed_once(call: Call, tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    for name in ("a", "b", "c"):
        csv_of(tmp_path / "logs" / f"{name}.csv", {"t": ["0.0", "1.0"], "lat": ["44.0", "44.1"]})
    csv_of(tmp_path / "logs" / "d.csv", {"id": ["1", "2"]})
    said = call(tmp_path / "logs", "--list")
    assert said.count("  lat: ") == said.count("  id: ") == 1
    assert "b and 1 other: the same tables and fields as a; name one alone for its values" in said


def test_what_a_bag_gives_without_a_mapping_is_listed(call: Call, tmp_path: Path) -> None:
    log, boat = bag(tmp_path / "trip.bag", "ros1", 3.0), written(tmp_path, "twin")
    *_, found = call(log, "--list", "--boat", boat).splitlines()
    taken = dict(part.split(" from ")[::-1] for part in found.partition(": ")[2].split("; "))
    assert found.startswith("taken without --map: ")
    assert taken["boat_odometry"] == "x, y, qw, qx, qy, qz, u, v, r"
    assert taken["thrusters_port_throttle"] == "throttle_port"
    *_, found, missing = call(log, "--list", "--boat", "esso_osaka").splitlines()
    assert missing == "not found, needs --map: rudder_main, propeller_main"


def test_several_messages_of_one_type_are_listed_as_the_import_refuses_them() -> None:
    pose = {name: np.arange(3.0) for name in ("x", "y", "theta")}
    tables = {
        name: LogTable(name, Table(pose, np.arange(1, 4)), np.arange(3.0), "geometry_msgs/Pose2D")
        for name in ("set_point", "ins")
    }
    (line,) = taken_by_default("rosbag", Log("trip.bag", "trip", tables), load_boat("swamp"))
    assert line.startswith("the position may be that of 2 topics of geometry_msgs/Pose2D (ins, set_point)")


def logged(**columns: list[float]) -> Log:
    table = Table({name: np.array(values) for name, values in columns.items()}, np.arange(1, 4))
    return Log("day.csv", "day", {"day": LogTable("day", table)})


@pytest.mark.parametrize(
    ("heading", "said"),
    [
        ([1.0, 3.0, -2.0], "heading"),
        ([6.0, 7.0, 8.0], "heading"),  # counts its turns
        ([350.0, 359.0, 2.0], "heading [deg]"),
        ([-12.0, -50.0, 30.0], "heading [deg]"),
    ],
)
def test_a_heading_without_a_unit_is_in_degrees_if_no_radians_are_so_large(
    heading: list[float], said: str
) -> None:
    found, _ = suggested("esso_osaka", logged(t=[0.0, 1.0, 2.0], heading=heading, rudder=[-0.3, 0.0, 0.3]))
    assert (found["heading"], found["rudder_main"]) == (said, "rudder")
    found, _ = suggested("esso_osaka", logged(t=[0.0, 1.0, 2.0], heading=heading, rudder=[-30.0, 0.0, 30.0]))
    assert found["rudder_main"] == "rudder [deg]"


def test_pulse_widths_of_a_command_are_no_degrees() -> None:
    pulses = [1500.0, 1900.0, 1100.0]
    assert suggested("esso_osaka", logged(rudder=pulses))[0]["rudder_main"] == "rudder"
    assert suggested("swamp", logged(azimuth_bs=pulses))[0]["azimuth_bs"] == "azimuth_bs"


def test_coordinates_in_degrees_are_suggested_as_latitude_and_longitude() -> None:
    near, far = [39.94333, 39.94335, 39.94431], [-100.20056, -100.20001, -100.19897]
    found, _ = suggested("esso_osaka", logged(x=near, y=far))
    assert (found["latitude"], found["longitude"]) == ("x", "y") and not {"x", "y"} & found.keys()
    found, _ = suggested("esso_osaka", logged(x=far, y=near))
    assert (found["latitude"], found["longitude"]) == ("y", "x")
    found, _ = suggested("esso_osaka", logged(x=[0.0, 1.0, 2.0], y=near))
    assert (found["x"], found["y"]) == ("x", "y")


def test_coordinates_in_tables_of_other_lengths_are_compared_by_their_sizes() -> None:
    values = {"a": {"x": np.array([39.94333, 39.94335])}, "b": {"y": np.array([9.2, 9.2001, 9.2002])}}
    tables = {name: LogTable(name, Table(one, np.arange(3))) for name, one in values.items()}
    found, _ = suggested("esso_osaka", Log("day", "day", tables))
    assert (found["latitude"], found["longitude"]) == ("a.x", "b.y")


@pytest.mark.parametrize(
    ("columns", "found"),
    [
        (["u", "v", "r", "psi"], {"u": "u", "v": "v", "r": "r [deg/s]"}),
        (["v", "r", "psi"], {}),
        (["surge", "v", "r", "psi"], {"u": "surge"}),
        (["u", "r", "yaw_rate", "psi"], {"u": "u", "yaw_rate": "yaw_rate"}),
        (["U", "V", "R", "psi"], {"u": "U", "v": "V", "r": "R [deg/s]"}),
        (["u (m/s)", "r (rad/s)", "psi"], {"u": "`u (m/s)`", "r": "`r (rad/s)`"}),
    ],
)
def test_v_and_r_are_the_sway_and_the_yaw_rate_beside_u(columns: list[str], found: dict[str, str]) -> None:
    rows = np.arange(1, 4)
    values = {name: np.array([90.0, 180.0, 270.0]) for name in columns}
    log = Log("day.csv", "day", {"day": LogTable("day", Table(values, rows))})
    options, _ = suggested("swamp", log)
    assert {name: told for name, told in options.items() if name != "heading"} == found


def test_v_and_r_are_those_of_the_table_of_u() -> None:
    columns = {"log": ["u", "v", "r"], "wind": ["v", "r"]}
    found, _ = suggested("swamp", log_of(**columns))
    assert found == {"u": "log.u", "v": "log.v", "r": "log.r"}


def test_a_time_vector_and_a_short_azimuth_are_suggested(tmp_path: Path) -> None:
    options, _ = suggested(str(file_of(tmp_path, "outboard")), log_of(day=["tvec", "Azi"]))
    assert options == {"time": "tvec", "azimuth_outboard": "Azi"}
