"""Logs of ArduPilot, PX4 and ROS by their default mappings, listed, and damaged in every way."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.logs.import_logs import Reading, import_logs, read_log
from swamp_rl.logs.listing import listing
from swamp_rl.logs.mapping import Frame, mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.binary_logs import bag, bag_without_definitions, dataflash, receiver_bag, ulog
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import written
from tests.support.logs import weaving

for package in ("pymavlink", "pyulog", "rosbags"):
    pytest.importorskip(package, reason=f"{package} is not installed; logs of autopilots are not tested")

LOGS = {
    "dataflash": (lambda folder: dataflash(folder / "log.bin"), "dataflash", []),
    "old dataflash": (lambda folder: dataflash(folder / "log.bin", old=True), "dataflash", []),
    "ulog": (lambda folder: ulog(folder / "log.ulg"), "ulog", []),
    "ros1": (lambda folder: bag(folder / "log.bag", "ros1"), "rosbag", []),
    "sqlite3": (lambda folder: bag(folder / "log", "sqlite3"), "rosbag", []),
    "mcap": (lambda folder: bag(folder / "log", "mcap"), "rosbag", []),
}


def imported(path: Path, kind: str, options: list[str], frame: Frame | None = None) -> Run:
    boat = str(written(path.parent, "twin"))
    out = path.parent / "out"
    import_logs([path], kind, out, About(boat=boat), Wishes(), Reading(mapping_of(options, frame)))
    (run,) = read_dataset(out).runs
    return run


@pytest.mark.parametrize("name", LOGS)
def test_the_default_mapping_gives_the_run_that_was_logged(tmp_path: Path, name: str) -> None:
    make, kind, options = LOGS[name]
    run, was = imported(make(tmp_path), kind, options), weaving()
    assert run.duration == pytest.approx(30.0, abs=0.3)
    columns = ["north", "east", "heading", "surge", "sway", "throttle_port", "throttle_starboard"]
    for column in columns + ([] if name == "ulog" else ["yaw_rate"]):
        expected = np.interp(run.time, was["time"], was[column])
        assert run.columns[column] == pytest.approx(expected, abs=0.03), column
    meta = run.meta.model_extra or {}
    assert "joined" in meta
    assert not any(word in meta.get("not_imported", "") for word in ("Time", "stamp"))


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_a_lone_file_of_a_bag_is_read_without_its_description(tmp_path: Path, storage: str) -> None:
    folder = bag(tmp_path / "bag", storage)
    (lone,) = [path for path in folder.iterdir() if path.name != "metadata.yaml"]
    run = imported(lone.rename(tmp_path / f"lone{lone.suffix}"), "rosbag", [])
    assert run.duration > 29.0 and {"throttle_port", "throttle_starboard"} <= set(run.columns)


@pytest.mark.parametrize("profile", ["ros1", ""])
def test_an_mcap_file_of_another_profile_is_refused_by_it(tmp_path: Path, profile: str) -> None:
    path = tmp_path / "log.mcap"
    header = b"".join(len(word).to_bytes(4, "little") + word for word in (profile.encode(), b"a recorder"))
    path.write_bytes(b"\x89MCAP0\r\n\x01" + len(header).to_bytes(8, "little") + header + bytes(64))
    with pytest.raises(
        UserError, match=rf"log\.mcap: its MCAP profile is '{profile}', of a bag ros2; name the"
    ):
        read_log(path, "rosbag")


@pytest.mark.parametrize("name", LOGS)
def test_a_listing_names_tables_rates_and_fields(tmp_path: Path, name: str) -> None:
    make, kind, _ = LOGS[name]
    lines = list(listing(read_log(make(tmp_path), kind)))
    expected = {
        "dataflash": "GPS, DataFlash: 151 rows, 5 Hz",
        "old dataflash": "GPS, DataFlash: 151 rows, 5 Hz",
        "ulog": "vehicle_attitude, ULog: 601 rows, 20 Hz",
    }.get(name, "boat_odometry (/boat/odometry), nav_msgs/Odometry: 301 rows, 10 Hz")
    assert expected in lines
    assert any(
        line.startswith("  ") and ".".join(expected.split(",")[0].split(" ")[:1]) in line for line in lines
    )


def test_a_given_column_holds_over_the_default(tmp_path: Path) -> None:
    run = imported(dataflash(tmp_path / "log.bin"), "dataflash", ["heading=0", "surge=0*GPS.Spd+1"])
    assert np.abs(run.columns["heading"]).max() == 0.0 and run.columns["surge"].min() == 1.0
    assert "sway" not in run.columns


def test_a_misspelt_column_is_reported_with_the_name_that_it_is_like(call: Call, tmp_path: Path) -> None:
    log, boat = dataflash(tmp_path / "log.bin", 12.0), written(tmp_path, "twin")
    words = ("runs", "import", log, "--boat", boat, "--map", "wind_sped=GPS.Spd", "--out", "runs")
    code, message, _ = call(*words)
    assert code == 0
    assert "unknown columns: wind_sped (did you mean 'wind_speed'?); kept as they are" in message


def test_a_yaw_that_counts_its_turns_is_taken(tmp_path: Path) -> None:
    run = imported(dataflash(tmp_path / "log.bin"), "dataflash", ["yaw=integral(0*IMU.GyrZ - 1.0)"])
    assert run.columns["heading"][50] == pytest.approx(-10.0 + 4.0 * np.pi, abs=1e-6)


def test_commands_mapped_of_a_bag_leave_the_frame_of_its_other_messages(tmp_path: Path) -> None:
    options = [f"throttle_{side}=thrusters_{side}_throttle.data" for side in ("port", "starboard")]
    run, was = imported(bag(tmp_path / "log", "sqlite3"), "rosbag", options), weaving()
    for column in ("north", "east", "heading", "sway", "yaw_rate"):
        expected = np.interp(run.time, was["time"], was[column])
        assert run.columns[column] == pytest.approx(expected, abs=0.03), column


@pytest.mark.parametrize(
    ("name", "option", "frame"),
    [
        ("dataflash", "r=-IMU.GyrZ", "enu"),
        ("ulog", "u=0", "enu"),
        ("ros1", "r=-boat_odometry.twist.twist.angular.z", "ned"),
    ],
)
def test_a_frame_is_that_of_the_given_columns_alone(
    tmp_path: Path, name: str, option: str, frame: Frame
) -> None:
    make, kind, _ = LOGS[name]
    run, was = imported(make(tmp_path), kind, [option], frame), weaving()
    for column in ("north", "east", "heading", *(["yaw_rate"] if option.startswith("r") else [])):
        expected = np.interp(run.time, was["time"], was[column])
        assert run.columns[column] == pytest.approx(expected, abs=0.03), column


def test_a_frame_of_no_given_column_is_refused(call: Call, tmp_path: Path) -> None:
    log = dataflash(tmp_path / "log.bin", 12.0)
    result = call("runs", "import", log, "--frame", "enu", "--map", "wind_speed=0*GPS.Spd", "--out", "runs")
    assert_complains(result, "--frame enu: is of columns that --map gives, and none is x, y, yaw, qw")


def test_the_headers_of_a_simulation_have_a_clock_of_their_own(tmp_path: Path) -> None:
    run, was = imported(bag(tmp_path / "log", "mcap", headers_late=1.7e9 - 12.0), "rosbag", []), weaving()
    for column in ("north", "throttle_port"):
        expected = np.interp(run.time, was["time"], was[column])
        assert run.columns[column] == pytest.approx(expected, abs=0.03), column
    assert "behind the recorder's clock" in (run.meta.model_extra or {})["times"]


@pytest.mark.parametrize("axes", ["earth", "boat"])
def test_a_stamped_twist_is_of_the_axes_that_the_positions_agree_with(tmp_path: Path, axes: str) -> None:
    run, was = imported(receiver_bag(tmp_path / "log.bag", axes), "rosbag", []), weaving()
    for column in ("surge", "sway"):
        expected = np.interp(run.time, was["time"], was[column])
        assert run.columns[column] == pytest.approx(expected, abs=0.03), column
    assert ("velocity" in (run.meta.model_extra or {})) == (axes == "earth")


def test_a_stamped_twist_without_positions_is_one_line(call: Call, tmp_path: Path) -> None:
    log = receiver_bag(tmp_path / "log.bag", "earth", topics=("/vel",))
    assert_complains(call("runs", "import", log, "--out", "a"), "no message gives a valid position")


def test_a_log_without_a_heading_is_one_line_that_names_the_option_to_give(
    call: Call, tmp_path: Path
) -> None:
    log = receiver_bag(tmp_path / "log.bag", "boat", topics=("/fix",))
    result = call("runs", "import", log, "--out", "a")
    assert_complains(result, "no message gives a valid heading; see --list, and give --map")


def test_rows_are_taken_at_the_stamps_of_the_positions(tmp_path: Path) -> None:
    run = imported(receiver_bag(tmp_path / "log.bag", "boat", delay=0.07), "rosbag", [])
    steps = np.diff(weaving(rate=5.0)["north"])[1:]  # the first stamp lies before the Imu's
    assert np.diff(run.columns["north"]) == pytest.approx(steps, abs=1e-6)


def test_logs_whose_rates_differ_a_little_become_one_dataset(tmp_path: Path) -> None:
    logs = [dataflash(tmp_path / f"{rate:g}.bin", rate=rate) for rate in (5.0, 5.2, 4.9)]
    boat = str(written(tmp_path, "twin"))
    made = import_logs(
        logs, "dataflash", tmp_path / "out", About(boat=boat), Wishes(), Reading(mapping_of([]))
    )
    assert made.sample_rate == 5.0 and len(made.runs) == 3


def test_a_log_of_two_boots_becomes_two_runs(tmp_path: Path) -> None:
    log, boat = dataflash(tmp_path / "log.bin", boots=2), str(written(tmp_path, "twin"))
    import_logs([log], "dataflash", tmp_path / "out", About(boat=boat), Wishes(), Reading(mapping_of([])))
    one, other = read_dataset(tmp_path / "out").runs
    assert [one.name, other.name] == ["log-1", "log-2"]
    np.testing.assert_array_equal(one.columns["north"], other.columns["north"])
    assert one.duration == pytest.approx(30.0, abs=0.3)


def test_a_listing_of_a_bag_has_no_constants_of_its_types(tmp_path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    status = store.types["sensor_msgs/msg/NavSatStatus"]
    with Writer(tmp_path / "log", version=8) as writer:
        topic = writer.add_connection("/status", status.__msgtype__, typestore=store)
        writer.write(topic, 1, store.serialize_cdr(status(status=2, service=1), status.__msgtype__))
    assert [
        line.partition(":")[0].strip() for line in list(listing(read_log(tmp_path / "log", "rosbag")))[1:]
    ] == [
        "status",
        "service",
    ]


def test_elements_of_an_array_that_grows_are_kept(tmp_path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    array, layout = (
        store.types[f"std_msgs/msg/{name}"] for name in ("Float64MultiArray", "MultiArrayLayout")
    )
    with Writer(tmp_path / "log", version=8) as writer:
        topic = writer.add_connection("/commands", array.__msgtype__, typestore=store)
        for i, data in enumerate(([], [0.1], [0.2, 0.3], [0.4])):
            message = array(layout=layout(dim=[], data_offset=0), data=np.array(data, float))
            writer.write(topic, 1 + i, store.serialize_cdr(message, array.__msgtype__))
    columns = read_log(tmp_path / "log", "rosbag").tables["commands"].table.columns
    assert columns["data[0]"] == pytest.approx([np.nan, 0.1, 0.2, 0.4], nan_ok=True)
    assert columns["data[1]"] == pytest.approx([np.nan, np.nan, 0.3, np.nan], nan_ok=True)


def test_messages_that_a_bag_does_not_define_are_named_and_the_others_read(tmp_path: Path) -> None:
    folder = bag_without_definitions(tmp_path / "log")
    lines = list(listing(read_log(folder, "rosbag")))
    assert "  channels[1]: 1900 to 1900, 1 distinct value" in lines
    assert lines[-1].startswith("not read: /tank (tank_msgs/Level), which the bag does not define")
    with pytest.raises(UserError, match="/tank is of type tank_msgs/Level, which the bag does not define"):
        read_log(folder, "rosbag", {"tank"})


def cut_short(path: Path, share: float) -> None:
    held = path.read_bytes()
    path.write_bytes(held[: int(share * len(held))])


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize("share", [0.0, 0.001, 0.05, 0.5])
def test_a_log_cut_short_is_one_line_or_what_was_whole(tmp_path: Path, name: str, share: float) -> None:
    make, kind, options = LOGS[name]
    path = make(tmp_path)
    held = path if path.is_file() else next(p for p in path.iterdir() if p.name != "metadata.yaml")
    cut_short(held, share)
    try:
        run = imported(path, kind, options)
    except UserError as error:
        assert str(error) and all(len(line) < 2000 for line in str(error).splitlines())
        assert not (tmp_path / "out").exists()
        return
    assert np.isfinite(run.pose).all()


@pytest.mark.parametrize(
    ("suffix", "what"), [("bin", "DataFlash log"), ("ulg", "ULog file"), ("bag", "ROS bag")]
)
@pytest.mark.parametrize("content", [b"", b"another file"])
def test_a_file_of_another_kind_is_reported_by_its_beginning(
    call: Call, tmp_path: Path, suffix: str, what: str, content: bytes
) -> None:
    (tmp_path / f"log.{suffix}").write_bytes(content)
    result = call("runs", "import", f"log.{suffix}", "--out", "a")
    assert_complains(result, "does not begin as one; check its name")
    assert f"log.{suffix}: is no {what}" in result[2]


@pytest.mark.parametrize(("storage", "repair"), [("ros1", "rosbag reindex"), ("mcap", "mcap recover")])
def test_a_bag_without_its_end_is_reported_with_what_repairs_it(
    call: Call, tmp_path: Path, storage: str, repair: str
) -> None:
    made = bag(tmp_path / "log.bag", storage, 12.0)
    path = made if made.is_file() else next(made.glob("*.mcap")).rename(tmp_path / "log.mcap")
    cut_short(path, 0.5)
    result = call("runs", "import", path, "--out", "a")
    assert_complains(result, f"copy it again, or repair it with {repair}")
    assert "Error:" not in result[2]


@pytest.mark.parametrize("name", LOGS)
def test_a_log_with_flipped_bytes_never_ends_otherwise(tmp_path: Path, name: str) -> None:
    make, kind, _ = LOGS[name]
    path = make(tmp_path)
    held = path if path.is_file() else next(p for p in path.iterdir() if p.name != "metadata.yaml")
    whole, rng = held.read_bytes(), np.random.default_rng(3)
    for _ in range(6):
        data = np.frombuffer(whole, np.uint8).copy()
        data[rng.integers(0, len(data), 40)] = rng.integers(0, 256, 40)
        held.write_bytes(data.tobytes())
        try:
            list(listing(read_log(path, kind)))
        except UserError as error:
            assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("a: &a [x]\nb: *a\n", "relative_file_paths"),
        ("[", "malformed YAML"),
        ("rosbag2_bagfile_information: {relative_file_paths: [../../secret.db3]}", "secret.db3"),
        ("rosbag2_bagfile_information: {relative_file_paths: [], compression_mode: file}", "decompress"),
    ],
)
def test_a_hostile_description_of_a_bag_reaches_nothing(tmp_path: Path, text: str, part: str) -> None:
    folder = bag(tmp_path / "bag", "sqlite3", 2.0)
    (tmp_path.parent / "secret.db3").write_text("secret")
    (folder / "metadata.yaml").write_text(text)
    with pytest.raises(UserError, match=part) as error:
        read_log(folder, "rosbag")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (("version",), None, "version: must be a whole number, not null"),
        (("version",), 10, "version: must be at most 9, not 10"),
        (("duration",), 1.5, "duration: must be a mapping of keys to values, not 1.5"),
        (("files",), "x", "files: must be a list, not 'x'"),
        (
            ("topics_with_message_count", 0, "topic_metadata", "name"),
            3,
            "topic_metadata.name: must be text, not 3",
        ),
    ],
)
def test_a_faulty_description_of_a_bag_is_reported_by_its_key(
    tmp_path: Path, keys: tuple[str | int, ...], value: Any, message: str
) -> None:
    folder = bag(tmp_path / "bag", "sqlite3", 2.0)
    part: Any = (whole := read_yaml(folder / "metadata.yaml"))
    for key in ("rosbag2_bagfile_information", *keys[:-1]):
        part = part[key]
    part[keys[-1]] = value
    write_yaml(folder / "metadata.yaml", whole)
    with pytest.raises(UserError) as error:
        read_log(folder, "rosbag")
    assert str(error.value).startswith(f"{folder / 'metadata.yaml'}: rosbag2_bagfile_information.")
    assert message in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_damage_in_a_bag_is_reported_without_the_words_of_python(tmp_path: Path, storage: str) -> None:
    folder = bag(tmp_path / "bag", storage, 2.0)
    held = next(path for path in folder.iterdir() if path.name != "metadata.yaml")
    held.write_bytes(held.read_bytes().replace(b"/boat/odometry", b"/boat\xffodometry"))
    with pytest.raises(UserError) as error:
        read_log(folder, "rosbag")
    assert str(error.value) == f"{folder}: is not a complete ROS bag; copy it again"


def test_a_link_in_a_bag_is_refused(tmp_path: Path) -> None:
    folder = bag(tmp_path / "bag", "sqlite3", 2.0)
    (held,) = folder.glob("*.db3")
    held.rename(tmp_path / "elsewhere.db3")
    held.symlink_to(tmp_path / "elsewhere.db3")
    with pytest.raises(UserError, match="is a link"):
        read_log(folder, "rosbag")


def test_the_verb_lists_imports_and_refuses(call: Call, tmp_path: Path) -> None:
    log = dataflash(tmp_path / "log.bin", 12.0)
    code, message, _ = call("runs", "import", log, "--from", "dataflash", "--list")
    assert code == 0 and "  GPS.Lat: " in message
    boat = written(tmp_path, "twin")
    code, message, _ = call("runs", "import", log, "--from", "dataflash", "--boat", boat, "--out", "runs")
    assert code == 0 and "joined: GPS 5 Hz" in message and "1 run, 61 rows at 5 Hz" in message
    (tmp_path / "other.bin").write_bytes(b"no log")
    for words, part in (
        (["other.bin", "--out", "a"], "is no DataFlash log"),
        ([log], "--out"),
        ([log, "--out", "a", "--drop", "x"], "--map"),
        ([log, "--out", "a", "--map", "heading=GPS.Nix"], "GPS has no field 'Nix'"),
        ([log, "--out", "a", "--map", "heading=GPS"], "GPS is a table; name its field"),
        ([log, "--out", "a", "--map", "heading=ATT.Yaw"], "as angles in degrees do; give it in radians"),
        ([log, "--out", "a", "--degrees", "heading"], "no such column; it has latitude, longitude, yaw"),
        ([log, "--out", "a", "--map", "heading=sin(1, 2)"], "sin() takes 1 argument, not 2"),
    ):
        assert_complains(call("runs", "import", *words, "--from", "dataflash"), part)
    assert not Path("a").exists()


def test_the_verb_knows_the_folder_of_a_bag_and_says_which_commands_are_missing(
    call: Call, tmp_path: Path
) -> None:
    folder = bag(tmp_path / "day 1", "mcap", 12.0)
    code, message, _ = call("runs", "import", folder, "--out", "runs")
    assert code == 0 and "commands: missing: azimuth_" in message and "--map azimuth_" in message
    code, message, _ = call("runs", "import", folder, "--boat", written(tmp_path, "twin"), "--out", "twin")
    assert code == 0 and "commands: missing" not in message
