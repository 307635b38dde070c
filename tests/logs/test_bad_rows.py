"""Rows of logs that are bad, whatever quantities the mapping reads."""

import re
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.bad_rows import BadRows
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.binary_logs import bag
from tests.support.from_scratch import written
from tests.support.logs import csv_of, geodetic, weaving

ABSOLUTE = ["time=t", "north=n", "east=e", "heading=psi"]
MAPPINGS = {
    "x": (["time=t", "x=n", "y=e", "yaw=psi"], "n", "north"),
    "y": (["time=t", "x=n", "y=e", "yaw=psi"], "e", "east"),
    "yaw": (["time=t", "x=n", "y=e", "yaw=psi"], "psi", "heading"),
    "quaternion": (["time=t", "x=n", "y=e", "qw=w", "qx=0", "qy=0", "qz=z"], "z", "heading"),
    "u": ([*ABSOLUTE, "u=speed"], "speed", "surge"),
    "v": ([*ABSOLUTE, "v=speed"], "speed", "sway"),
    "r": ([*ABSOLUTE, "r=turn"], "turn", "yaw_rate"),
    "vx": ([*ABSOLUTE, "vx=speed", "vy=0"], "speed", "surge"),
    "velocity_east": ([*ABSOLUTE, "velocity_north=0", "velocity_east=speed"], "speed", "sway"),
}


@pytest.fixture
def boat(tmp_path: Path) -> str:
    return str(written(tmp_path, "twin"))


def imported(log: Path, boat: str, options: list[str], wishes: Wishes, **given: str) -> list[Run]:
    kind = "rosbag" if log.suffix == ".bag" else "csv"
    out = log.parent / f"{wishes.bad_rows}-{wishes.fill:g}"
    import_logs([log], kind, out, About(boat=boat), wishes, Reading(mapping_of(options, **given)))
    return read_dataset(out).runs


def with_an_empty_cell(folder: Path, column: str, row: int) -> Path:
    was = weaving()
    values = {"t": was["time"], "n": was["north"], "e": was["east"], "psi": was["heading"]}
    values |= {"w": np.cos(was["heading"] / 2), "z": np.sin(was["heading"] / 2)}
    values |= {"speed": was["surge"], "turn": was["yaw_rate"]}
    cells = {name: [repr(float(value)) for value in column] for name, column in values.items()}
    cells[column][row - 1] = ""
    return csv_of(folder / "log.csv", cells)


@pytest.mark.parametrize("name", MAPPINGS)
def test_a_row_without_a_mapped_quantity_is_reported_and_can_be_left_out(
    tmp_path: Path, boat: str, name: str
) -> None:
    options, column, ours = MAPPINGS[name]
    log = with_an_empty_cell(tmp_path, column, 101)
    with pytest.raises(UserError) as error:
        imported(log, boat, options, Wishes())
    (line,) = str(error.value).splitlines()
    assert f"log.csv: row 101 (line 102), column {ours}: is missing; fill it in" in line
    assert f"(there '{column}') (--bad-rows cut or split)" in line
    (longest,) = imported(log, boat, options, Wishes(bad_rows="cut"))
    assert len(longest.time) == 200
    runs = imported(log, boat, options, Wishes(bad_rows="split"))
    assert [len(run.time) for run in runs] == [100, 200]


def test_a_row_without_a_quantity_of_an_enu_frame_is_reported_by_the_column_of_the_run(
    tmp_path: Path, boat: str
) -> None:
    log = with_an_empty_cell(tmp_path, "n", 101)
    with pytest.raises(UserError, match=r"row 101 \(line 102\), column east: is missing"):
        imported(log, boat, MAPPINGS["x"][0], Wishes(), frame="enu")


MARKED = {
    "north": "x=pos.n",
    "surge": "u=pos.speed",
    "yaw_rate": "r=pos.turn",
    "heading": "yaw=pos.psi",
    "latitude": "latitude=pos.lat",
    "throttle_port": "throttle_port=cmd.port",
}


def marked(folder: Path, ours: str, rows: slice) -> list[Path]:
    """Tables of positions and of commands, with a mark in some rows of what becomes a column."""
    was = weaving()
    lat, lon = geodetic(was)
    place = {"n": was["north"], "e": was["east"], "lat": lat, "lon": lon}
    motion = {"psi": np.mod(4.0 * was["heading"], 6.28), "speed": was["surge"], "turn": was["yaw_rate"]}
    tables = {"pos": place | motion, "cmd": {"port": was["throttle_port"], "stb": was["throttle_starboard"]}}
    table, _, column = MARKED[ours].partition("=")[2].partition(".")
    tables[table][column] = tables[table][column].copy()
    tables[table][column][rows] = -999.0
    made = {}
    for name, columns in tables.items():
        cells = {key: [repr(float(value)) for value in own] for key, own in columns.items()}
        made[name] = {"t": [f"{t:.1f}" for t in was["time"]], **cells}
    csv_of(folder / "both.csv", made["pos"] | made["cmd"])
    return [csv_of(folder / f"{name}.csv", columns) for name, columns in made.items()]


def with_place(ours: str) -> list[str]:
    """Mapping of the marked tables: of latitude and longitude, or of x and y."""
    place = "latitude=pos.lat longitude=pos.lon" if ours == "latitude" else "x=pos.n y=pos.e"
    others = "time=t yaw=pos.psi u=pos.speed r=pos.turn"
    return f"{place} {others} throttle_port=cmd.port throttle_starboard=cmd.stb".split()


@pytest.mark.parametrize("ours", MARKED)
def test_a_mark_of_any_quantity_is_reported_and_its_row_cut(tmp_path: Path, boat: str, ours: str) -> None:
    marked(tmp_path, ours, slice(100, 101))
    options = [option.replace("pos.", "").replace("cmd.", "") for option in with_place(ours)]
    with pytest.raises(UserError) as error:
        imported(tmp_path / "both.csv", boat, options, Wishes())
    (line,) = str(error.value).splitlines()
    assert f"row 101 (line 102), column {ours}: is missing, marked by -999" in line
    (run,) = imported(tmp_path / "both.csv", boat, options, Wishes(bad_rows="cut"))
    assert len(run.time) == 200


@pytest.mark.parametrize("ours", MARKED)
def test_a_mark_in_a_joined_table_is_reported_wherever_it_matters(
    tmp_path: Path, boat: str, ours: str
) -> None:
    def joined(rows: slice, wishes: Wishes) -> Run:
        reading = Reading(mapping_of(with_place(ours)), join="both")
        out = tmp_path / f"{rows.stop}-{wishes.bad_rows}"
        import_logs(marked(tmp_path, ours, rows), "csv", out, About(boat=boat), wishes, reading)
        (run,) = read_dataset(out).runs
        return run

    short = joined(slice(100, 101), Wishes())
    (line,) = (short.meta.model_extra or {})["cells_left_out"]
    message = rf"csv: row 101 \(line 102\), column {ours}: is missing, marked by -999"
    assert re.search(message, line) and len(short.time) == 301
    with pytest.raises(
        UserError, match=rf"has no value for 1\.1 s \(\w+\.{message}\); --fill SECONDS fills it"
    ):
        joined(slice(100, 110), Wishes())
    assert len(joined(slice(100, 110), Wishes(bad_rows="cut")).time) == 191


@pytest.mark.parametrize(("bad_rows", "rows"), [("cut", [121]), ("split", [101, 121])])
def test_a_pause_of_a_bag_is_left_out(tmp_path: Path, boat: str, bad_rows: BadRows, rows: list[int]) -> None:
    pytest.importorskip("rosbags")
    log = bag(tmp_path / "log.bag", "ros1", pause=(10.0, 18.0))
    with pytest.raises(UserError, match=r"column east: boat_odometry has no value for 8 s; --fill SECONDS"):
        imported(log, boat, [], Wishes())
    runs = imported(log, boat, [], Wishes(bad_rows=bad_rows))
    assert [len(run.time) for run in runs] == rows


def test_a_pause_longer_than_the_rest_of_a_log_is_no_wrong_unit(tmp_path: Path, boat: str) -> None:
    pytest.importorskip("rosbags")
    log = bag(tmp_path / "log.bag", "ros1", pause=(5.0, 25.0))
    runs = imported(log, boat, [], Wishes(bad_rows="split"))
    assert [len(run.time) for run in runs] == [51, 51]


def test_empty_rows_that_outnumber_the_others_of_a_table_are_no_wrong_unit(tmp_path: Path, boat: str) -> None:
    was = weaving()
    cells = {"t": [f"{t:.1f}" for t in was["time"]]}
    for name, ours in {"n": "north", "e": "east", "psi": "heading", "port": "throttle_port"}.items():
        cells[name] = [repr(float(value)) if not 50 <= i < 250 else "" for i, value in enumerate(was[ours])]
    log = csv_of(tmp_path / "log.csv", cells)
    options = [*ABSOLUTE, "throttle_port=port", "throttle_starboard=port"]
    runs = imported(log, boat, options, Wishes(bad_rows="split"))
    assert [len(run.time) for run in runs] == [50, len(was["time"]) - 250]
    with pytest.raises(UserError, match="100% of the rows are bad, so a unit or the mapping is wrong"):
        imported(log, boat, [*options[:-1], "throttle_starboard=port+2"], Wishes(bad_rows="cut"))


def test_rows_beside_a_pause_that_are_bad_by_a_unit_are_still_refused(tmp_path: Path, boat: str) -> None:
    pytest.importorskip("rosbags")
    log = bag(tmp_path / "log.bag", "ros1", pause=(5.0, 25.0))
    throttle = ["throttle_port=boat_odometry.pose.pose.position.x + 2"]
    with pytest.raises(UserError, match="100% of the rows are bad, so a unit or the mapping is wrong"):
        imported(log, boat, throttle, Wishes(bad_rows="split"))


def test_steps_of_another_length_are_told_in_one_line(tmp_path: Path, boat: str) -> None:
    was = weaving()
    names = {"t": "time", "n": "north", "e": "east", "psi": "heading"}
    cells = {ours: [repr(float(value)) for value in was[name]] for ours, name in names.items()}
    log = csv_of(tmp_path / "log.csv", cells, drop=tuple(range(30, 300, 30)))
    runs = imported(log, boat, ABSOLUTE, Wishes(bad_rows="split"))
    assert len(runs) == 10
    _, *told = (runs[0].meta.model_extra or {})["rows_left_out"]
    assert len(told) == 1 and "0.2 s after the row before (in 9 of rows 31 to 263)" in told[0]


def test_a_unit_that_is_wrong_in_all_logs_is_told_once(tmp_path: Path, boat: str) -> None:
    was, logs = weaving(), []
    for name, rows in (("one", 250), ("two", 300)):
        cells = {"t": was["time"], "n": was["north"], "e": was["east"], "psi": np.degrees(was["heading"])}
        cells |= {"pwm": 1500.0 + 400.0 * was["throttle_port"]}
        text = {key: [repr(float(value)) for value in values[:rows]] for key, values in cells.items()}
        logs.append(csv_of(tmp_path / f"{name}.csv", text))
    reading = Reading(mapping_of([*ABSOLUTE, "throttle_port=pwm", "throttle_starboard=pwm/4000"]))
    with pytest.raises(UserError) as error:
        import_logs(logs, "csv", tmp_path / "out", About(boat=boat), Wishes(), reading)
    lines = str(error.value).splitlines()
    columns = sorted(line.partition("column ")[2].partition(":")[0] for line in lines)
    assert columns == ["heading", "throttle_port"]
    assert all(line.startswith("one.csv and 1 other: ") for line in lines)


def test_rows_that_an_expression_leaves_without_a_value_are_interpolated_as_the_refusal_says(
    tmp_path: Path, boat: str
) -> None:
    was = weaving()
    names = {"t": "time", "n": "north", "e": "east", "psi": "heading"}
    log = csv_of(
        tmp_path / "log.csv", {o: [repr(float(value)) for value in was[n]] for o, n in names.items()}
    )
    first, last = was["time"][[100, 103]]
    mapping = [*ABSOLUTE[:3], f"heading=where(abs(t-{first})<0.01, 0/0, where(abs(t-{last})<0.01, 0/0, psi))"]
    with pytest.raises(UserError, match="--bad-rows split --resample HZ --fill SECONDS interpolates"):
        imported(log, boat, mapping, Wishes())
    rate = 1.0 / float(np.median(np.diff(was["time"])))
    (run,) = imported(log, boat, mapping, Wishes(bad_rows="split", resample=rate, fill=1.0))
    assert len(run.time) == len(was["time"])
    assert np.abs(np.unwrap(run.columns["heading"]) - np.unwrap(was["heading"])).max() < 0.05
