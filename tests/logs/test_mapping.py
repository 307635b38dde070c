"""Tables of others by a mapping: expressions, times, frames, several tables, bad rows."""

import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs, read_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.resample import ALWAYS
from tests.support.from_scratch import written
from tests.support.logs import MAP, START, csv_of, stranger_columns, weaving


@pytest.fixture
def boat(tmp_path: Path) -> str:
    return str(written(tmp_path, "twin"))


def imported(
    path: Path | list[Path],
    boat: str,
    options: list[str],
    wishes: Wishes | None = None,
    join: str | None = None,
    folders: bool = False,
    **given: object,
) -> list[Run]:
    paths = path if isinstance(path, list) else [path]
    out = paths[0].parent / "out"
    kind = "parquet" if paths[0].suffix == ".parquet" else "csv"
    reading = Reading(mapping_of(options, **given), join, folders)
    import_logs(paths, kind, out, About(boat=boat), wishes or Wishes(), reading)
    return read_dataset(out).runs


def assert_is_the_run(run: Run, names: tuple[str, ...], atol: float = 2e-3) -> None:
    was = weaving()
    for name in names:
        expected = np.interp(run.time + was["time"][0], was["time"], was[name])
        assert run.columns[name] == pytest.approx(expected, abs=atol), name


def test_pulse_widths_epochs_and_places_become_a_run(tmp_path: Path, boat: str) -> None:
    path = csv_of(tmp_path / "log.csv", stranger_columns(weaving()))
    (run,) = imported(path, boat, MAP)
    assert_is_the_run(run, ("north", "east", "heading", "throttle_port", "throttle_starboard"))
    meta = run.meta.model_extra or {}
    assert meta["times"] == "ms since 1970, from 2023-11-14T22:13:20.000+00:00"
    assert meta["not_imported"] == "mode"


@pytest.mark.parametrize("kind", ["words", "parquet"])
def test_iso_times_are_known(tmp_path: Path, boat: str, kind: str) -> None:
    was = weaving()
    stamps = np.datetime64("2026-05-01T12:00:00.000") + (1000 * was["time"]).round().astype("timedelta64[ms]")
    columns = {"when": stamps, "n": was["north"], "e": was["east"], "psi": was["heading"]}
    path = tmp_path / f"log.{'parquet' if kind == 'parquet' else 'csv'}"
    if kind == "parquet":
        pq.write_table(pa.table({name: pa.array(values) for name, values in columns.items()}), path)
    else:
        csv_of(path, {name: [str(value) for value in values] for name, values in columns.items()})
    (run,) = imported(path, boat, ["time=when", "north=n", "east=e", "heading=psi"])
    assert run.time == pytest.approx(was["time"])
    assert "ISO 8601, from 2026-05-01T12:00:00.000+00:00" in str(run.meta.model_extra)


PLACES = {"n": "north", "e": "east", "psi": "heading"}


def test_times_of_a_day_are_known(tmp_path: Path, boat: str) -> None:
    was = weaving()
    stamps = np.datetime64("2026-05-01T14:05:00.000") + (1000 * was["time"]).round().astype("timedelta64[ms]")
    columns = {"clock": [str(stamp)[11:] for stamp in stamps]}
    columns |= {ours: [str(value) for value in was[theirs]] for ours, theirs in PLACES.items()}
    path = csv_of(tmp_path / "log.csv", columns)
    (run,) = imported(path, boat, ["time=clock", "north=n", "east=e", "heading=psi"])
    assert run.time == pytest.approx(was["time"] - was["time"][0])
    assert "of a day, from 14:05:0" in str(run.meta.model_extra)


@pytest.mark.parametrize("ticks", [1, 10**3, 10**6, 10**9])
def test_ticks_since_1970_are_known_by_their_size(tmp_path: Path, boat: str, ticks: int) -> None:
    was = weaving()
    stamps = [f"{(START + t) * ticks:.1f}" for t in was["time"]]
    columns = {"t": stamps, **{name: [str(x) for x in was[name]] for name in ("north", "east", "heading")}}
    (run,) = imported(
        csv_of(tmp_path / "log.csv", columns),
        boat,
        ["time=t", "north=north", "east=east", "heading=heading"],
        Wishes(resample=5.0),
    )
    assert_is_the_run(run, ("north", "east"), 2e-3)


@pytest.mark.parametrize("frame", ["ned", "enu"])
def test_frames_quaternions_and_velocities(tmp_path: Path, boat: str, frame: str) -> None:
    was, enu = weaving(), frame == "enu"
    yaw = 0.5 * np.pi - was["heading"] if enu else was["heading"]
    cos, sin = np.cos(was["heading"]), np.sin(was["heading"])
    north, east = was["surge"] * cos - was["sway"] * sin, was["surge"] * sin + was["sway"] * cos
    values = {
        "t": was["time"],
        "px": was["east"] if enu else was["north"],
        "py": was["north"] if enu else was["east"],
        "w": np.cos(yaw / 2),
        "z": np.sin(yaw / 2),
        "vx": east if enu else north,
        "vy": north if enu else east,
        "gz": -was["yaw_rate"] if enu else was["yaw_rate"],
    }
    path = csv_of(tmp_path / "log.csv", {name: [repr(float(x)) for x in v] for name, v in values.items()})
    options = ["time=t", "x=px", "y=py", "qw=w", "qx=0", "qy=0", "qz=z", "vx=vx", "vy=vy", "r=gz"]
    (run,) = imported(path, boat, options, frame=frame)
    assert_is_the_run(run, ("north", "east", "heading", "surge", "sway", "yaw_rate"), 1e-9)
    assert run.meta.velocity_axes == "earth"


def two_tables(folder: Path, shift: float = 0.0, lost: tuple[int, ...] = ()) -> list[Path]:
    """Places at 5 Hz and attitude at 20 Hz by a clock that is `shift` s late; lost: rows of the places."""
    slow, fast = weaving(rate=5.0), weaving(rate=20.0)
    late = (fast["time"] + shift).round(6)
    columns = {"t": slow["time"], "n": slow["north"], "e": slow["east"], "course": slow["heading"]}
    gps = csv_of(folder / "gps.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()}, lost)
    columns = {"t": late, "psi": np.degrees(fast["heading"]) + 350.0, "p": fast["throttle_port"]}
    columns["s"] = fast["throttle_starboard"]
    ahrs = csv_of(folder / "ahrs.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})
    return [gps, ahrs]


JOINED = [
    "time=t",
    "north=gps.n",
    "east=gps.e",
    "heading=radians(ahrs.psi - 350)",
    "throttle_port=ahrs.p",
    "throttle_starboard=ahrs.s",
]


def test_tables_are_joined_at_the_rate_of_the_places_and_it_is_reported(tmp_path: Path, boat: str) -> None:
    (run,) = imported(two_tables(tmp_path), boat, JOINED, join="trip")
    assert run.name == "trip"
    assert_is_the_run(run, ("heading", "throttle_port"))
    joined = (run.meta.model_extra or {})["joined"]
    assert joined == "gps 5 Hz, ahrs 20 Hz; at 5 Hz, linear between messages, commands held"
    shutil.rmtree(tmp_path / "out")
    (run,) = imported(two_tables(tmp_path)[:1], boat, ["time=gps.t", *JOINED[1:3], "heading=gps.course"])
    assert "not_imported" not in (run.meta.model_extra or {})


def exported_bag(folder: Path, name: str) -> Path:
    """A folder as exporters of bags leave it: files of one name, an empty one, words."""
    bag = folder / "bags" / name / name
    for topic in ("sensors/front", "sensors/rear", "notes"):
        (bag / topic).mkdir(parents=True)
    gps, ahrs = two_tables(folder)
    gps.rename(bag / "gps.csv")
    ahrs.rename(bag / "sensors" / "front" / "ahrs.csv")
    (bag / "sensors" / "rear" / "ahrs.csv").write_text("t,psi\n1.0,nonsense\n")
    (bag / "notes" / "empty.csv").write_bytes(b"")
    (bag / "notes" / "text.csv").write_text("t,words\n1,\"{'level': 0, 'name': 'a, b'}\"\n")
    return folder / "bags" / name


IN_FOLDERS = [
    "time=t",
    "north=gps.n",
    "east=gps.e",
    "heading=radians(sensors_front_ahrs.psi - 350)",
    "throttle_port=sensors_front_ahrs.p",
    "throttle_starboard=sensors_front_ahrs.s",
]


def test_each_folder_of_tables_is_a_run_whatever_else_is_in_it(tmp_path: Path, boat: str) -> None:
    bags = [exported_bag(tmp_path, name) for name in ("first", "second")]
    runs = imported(bags, boat, IN_FOLDERS, folders=True)
    assert [run.name for run in runs] == ["first", "second"]
    for run in runs:
        assert_is_the_run(run, ("heading", "throttle_port"))
    (log,) = read_logs(bags[:1], "csv", None, True)
    assert sorted(log.tables) == ["gps", "notes_text", "sensors_front_ahrs", "sensors_rear_ahrs"]
    assert log.metadata["not_read"] == "notes_empty (empty)"


def test_what_is_no_folder_of_tables_is_reported(tmp_path: Path, boat: str) -> None:
    bag = exported_bag(tmp_path, "first")
    wrong = [IN_FOLDERS[0], *(one.replace("front", "frnt") for one in IN_FOLDERS[1:])]
    with pytest.raises(UserError, match="no table 'sensors_frnt_ahrs'; did you mean 'sensors_front_ahrs'"):
        imported(bag, boat, wrong, folders=True)
    with pytest.raises(UserError, match=r"same name as .* or give --join-folders"):
        imported(bag, boat, IN_FOLDERS)
    (gps,) = bag.rglob("gps.csv")
    with pytest.raises(UserError, match=r"gps\.csv: is not a folder"):
        imported(gps, boat, IN_FOLDERS, folders=True)
    (bag / "first" / "sensors_front").mkdir()
    gps.rename(bag / "first" / "sensors_front" / "ahrs.csv")
    with pytest.raises(UserError, match=r"is the table sensors_front_ahrs like .*; rename one"):
        imported(bag, boat, IN_FOLDERS, folders=True)


def test_joined_tables_have_no_more_rows_than_their_messages_can_fill(tmp_path: Path, boat: str) -> None:
    with pytest.raises(UserError, match=f"at most {ALWAYS}; give --resample HZ, or divide the log"):
        imported(two_tables(tmp_path), boat, JOINED, Wishes(resample=2e4), join="trip")


def test_the_offset_between_two_clocks_is_found_and_reported(tmp_path: Path, boat: str) -> None:
    clock = ["turn_rate(gps.course) ~ turn_rate(radians(ahrs.psi))"]
    (run,) = imported(two_tables(tmp_path, shift=1.3), boat, JOINED, join="trip", clock=clock)
    assert_is_the_run(run, ("heading",), 0.02)
    assert "ahrs shifted by -1.3" in (run.meta.model_extra or {})["clocks"]


def test_clocks_of_three_tables_are_compared_in_a_chain(tmp_path: Path, boat: str) -> None:
    paths = two_tables(tmp_path, shift=1.3)
    fast = weaving(rate=20.0)
    columns = {"t": (fast["time"] + 3.0).round(6), "turn": np.gradient(fast["heading"], fast["time"])}
    columns["p"] = fast["throttle_port"]
    paths.append(csv_of(tmp_path / "imu.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()}))
    options = ["throttle_port=imu.p" if one == "throttle_port=ahrs.p" else one for one in JOINED]
    to_gps = "turn_rate(gps.course) ~ turn_rate(radians(ahrs.psi))"
    to_ahrs = "turn_rate(radians(ahrs.psi)) ~ imu.turn"
    (run,) = imported(paths, boat, options, join="trip", clock=[to_gps, to_ahrs])
    meta = (run.meta.model_extra or {})["clocks"]
    assert "ahrs shifted by -1.3" in meta and re.search(r"imu shifted by -(3\.0|2\.99)", meta)
    shutil.rmtree(tmp_path / "out")
    with pytest.raises(UserError, match="the clock of ahrs is settled by an earlier --clock"):
        imported(paths, boat, options, join="trip", clock=[to_ahrs, to_gps])


def test_a_clock_of_other_quantities_is_refused(tmp_path: Path, boat: str) -> None:
    for other, message in ("-rate(ahrs.p)*0 + 1", "correlation"), ("ahrs.z", "ahrs has no field 'z'"):
        with pytest.raises(UserError, match=rf"--clock gps\.n ~ {re.escape(other)}: {message}"):
            imported(two_tables(tmp_path), boat, JOINED, join="trip", clock=[f"gps.n ~ {other}"])


def test_a_pause_of_a_table_is_a_bad_stretch_and_can_be_filled(tmp_path: Path, boat: str) -> None:
    paths = two_tables(tmp_path, lost=tuple(range(40, 60)))
    with pytest.raises(UserError, match=r"gps has no value for 4\.2 s"):
        imported(paths, boat, JOINED, join="trip")
    runs = imported(paths, boat, JOINED, Wishes(bad_rows="split"), join="trip")
    assert [run.name for run in runs] == ["trip-1", "trip-2"]
    shutil.rmtree(tmp_path / "out")
    (run,) = imported(paths, boat, JOINED, Wishes(fill=5.0), join="trip")
    assert run.duration == pytest.approx(30.0)


def with_faults(folder: Path) -> Path:
    columns = stranger_columns(weaving())
    for row in (50, 51, 52):
        columns["lat"][row] = ""
    columns["lat"][120] = columns["lon"][120] = "0.0"
    columns["compass"][200] = "nan"
    return csv_of(folder / "log.csv", columns, drop=(250,))


def test_all_faults_are_listed_with_what_to_do(tmp_path: Path, boat: str) -> None:
    with pytest.raises(UserError) as error:
        imported(with_faults(tmp_path), boat, MAP)
    lines = str(error.value).splitlines()
    assert any(
        "row 51 (line 52), column latitude" in line and "rows 51 to 53: 3 rows" in line for line in lines
    )
    assert any("without a fix" in line for line in lines)
    assert any("row 201" in line and "column heading" in line for line in lines)
    assert any("--bad-rows" in line for line in lines) and not (tmp_path / "out").exists()


def test_cut_keeps_the_longest_stretch_and_split_all_of_them(tmp_path: Path, boat: str) -> None:
    path = with_faults(tmp_path)
    runs = imported(path, boat, MAP, Wishes(bad_rows="split"))
    assert [len(run.time) for run in runs] == [50, 67, 79, 49, 50]
    meta = (runs[0].meta.model_extra or {})["rows_left_out"]
    assert meta[0].startswith("5 of 300 rows left out; kept are rows 1 to 50, 54 to 120, 122 to 200,")
    assert any("row 251" in line and "0.2 s after the row before" in line for line in meta)
    shutil.rmtree(tmp_path / "out")
    (longest,) = imported(path, boat, MAP, Wishes(bad_rows="cut"))
    assert longest.name == "log" and longest.duration == pytest.approx(7.8)
    shutil.rmtree(tmp_path / "out")
    (filled,) = imported(path, boat, MAP, Wishes(bad_rows="cut", resample=10.0, fill=1.0))
    assert_is_the_run(filled, ("north", "east"), 5e-3)
    assert len(filled.time) == 301


def test_a_unit_mistake_is_not_cut_away(tmp_path: Path, boat: str) -> None:
    path = csv_of(tmp_path / "log.csv", stranger_columns(weaving()))
    options = [*MAP[:3], "heading=compass", *MAP[4:]]
    with pytest.raises(UserError, match="of the rows are bad, so a unit or the mapping is wrong") as error:
        imported(path, boat, options, Wishes(bad_rows="split"))
    assert "degrees" in str(error.value) and not (tmp_path / "out").exists()


def test_times_that_come_again_or_go_back_are_borders(tmp_path: Path, boat: str) -> None:
    columns = stranger_columns(weaving())
    columns["epoch_ms"][30] = columns["epoch_ms"][29]
    path = csv_of(tmp_path / "log.csv", columns)
    path.write_text(path.read_text() + "\n".join(path.read_text().splitlines()[1:40]) + "\n")
    runs = imported(path, boat, MAP, Wishes(bad_rows="split"))
    assert [len(run.time) for run in runs] == [30, 270, 30]


@pytest.mark.parametrize(
    ("options", "wishes", "part"),
    [
        (["north=n"], Wishes(), "there is no column 'n'"),
        ([*MAP, "surge=speed"], Wishes(), "there is no column 'speed'"),
        (MAP[1:], Wishes(), "add --map time=COLUMN"),
        ([*MAP[1:], "time=mode"], Wishes(), "is not a time"),
        ([*MAP[:3], "yaw=compass"], Wishes(), "--map yaw: reaches"),
        ([*MAP, "qw=lat"], Wishes(), "qx"),
        ([*MAP, "yaw=lat"], Wishes(), "heading and yaw"),
        ([*MAP, "vx=lat"], Wishes(), "no vy"),
        (MAP, Wishes(units={"sway": "kn"}), "--unit or --degrees sway"),
        (["time=epoch_ms"], Wishes(), "no column but time"),
        (MAP, Wishes(bad_rows="cut", rate=None, resample=None), None),
        ([option for option in MAP if "heading" not in option], Wishes(), "column heading: is missing"),
    ],
)
def test_a_mapping_that_does_not_fit_is_refused(
    tmp_path: Path, boat: str, options: list[str], wishes: Wishes, part: str | None
) -> None:
    path = csv_of(tmp_path / "log.csv", stranger_columns(weaving()))
    if part is None:
        assert len(imported(path, boat, options, wishes)) == 1
        return
    with pytest.raises(UserError) as error:
        imported(path, boat, options, replace(wishes))
    assert part in str(error.value), str(error.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("columns: {north: n, east: {value: e, unit: parsec}}", "columns.east"),
        ("columns: {'a b': n}", "not a column name"),
        ("columns: {north: 'n +'}", "columns.north: expression"),
        ("frame: up", "frame"),
        ("colums: {north: n}", "did you mean 'columns'"),
        ("columns: {}", "columns"),
    ],
)
def test_a_mapping_file_is_checked_by_key(tmp_path: Path, text: str, part: str) -> None:
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(UserError) as error:
        mapping_of([str(tmp_path / "map.yaml")])
    assert part in str(error.value)


def test_options_hold_over_a_file(tmp_path: Path, boat: str) -> None:
    text = "columns:\n  time: epoch_ms\n  latitude: lat\n  longitude: lon\n"
    text += "  heading: {value: compass, unit: deg}\n  throttle_port: 5\n"
    (tmp_path / "map.yaml").write_text(text)
    path = csv_of(tmp_path / "log.csv", stranger_columns(weaving()))
    options = [str(tmp_path / "map.yaml"), *MAP[4:]]
    (run,) = imported(path, boat, options)
    assert_is_the_run(run, ("heading", "throttle_port"))
    for wrong in (["north"], ["a=1", "a=2"], ["a=(1"]):
        with pytest.raises(UserError, match="--map"):
            mapping_of(wrong)


def test_a_column_of_a_later_file_has_that_files_unit(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text("columns: {heading: {value: compass, unit: deg}}\n")
    (tmp_path / "two.yaml").write_text("columns: {heading: psi}\n")
    assert mapping_of([str(tmp_path / "one.yaml"), str(tmp_path / "two.yaml")]).units == {}


@pytest.mark.parametrize("name", ["\x1b[2J.csv", "a\nb.csv", "x" * 230 + ".csv"])
def test_a_log_whose_name_is_no_plain_one_is_not_imported(tmp_path: Path, boat: str, name: str) -> None:
    path = csv_of(tmp_path / name, stranger_columns(weaving()))
    with pytest.raises(UserError) as error:
        imported(path, boat, MAP)
    assert str(error.value).isprintable() and not (tmp_path / "out").exists()


def test_a_pipe_is_no_log(tmp_path: Path, boat: str) -> None:
    os.mkfifo(tmp_path / "log.csv")
    with pytest.raises(UserError, match="no such file or folder"):
        imported(tmp_path / "log.csv", boat, MAP)


def test_an_unknown_unit_of_a_mapping_file_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text("columns: {time: t, yaw_rate: {value: r, unit: furlong}}\n")
    with pytest.raises(UserError) as refused:
        mapping_of([str(tmp_path / "map.yaml")])
    (line,) = str(refused.value).splitlines()
    assert "is none; known units are deg, deg/s, deg/min" in line
