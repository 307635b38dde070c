"""`swamp-rl follow`, `follow-vehicle`, `hold` and `capability`: from a file to a folder that others read."""

import csv
import json
from pathlib import Path

import pytest

from swamp_rl.runs import check_dataset
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

MINE = (
    "name: mine\nspeed: 0.8\n"
    "pieces: [{kind: line, to: [12.0, 0.0]}, {kind: arc, radius: 4.0, turn_deg: 90.0}]\n"
)


@pytest.fixture(autouse=True)
def _path(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(MINE)


def test_a_followed_path_is_a_dataset_with_errors_energy_and_figure(call: Call, tmp_path: Path) -> None:
    code, message, complaint = call("follow", "mine.yaml", "--disturbances", "standard", "--out", "out")
    assert (code, complaint) == (0, "")
    assert "cross track error" in message
    assert check_dataset(tmp_path / "out") == []
    data = json.loads((tmp_path / "out/analysis/result.json").read_text())
    with (tmp_path / "out/analysis/track.csv").open() as file:
        across = [abs(float(row["across"])) for row in csv.DictReader(file)]
    assert data["completed"]
    assert data["cross_track_error"]["max"] == pytest.approx(max(across))
    assert data["electric_energy"] > 0.0
    assert (tmp_path / "out/analysis/track.png").stat().st_size > 1000
    assert call("follow", "mine.yaml", "--out", "out")[0] == 0  # its own result may be replaced


def test_a_boat_follows_the_run_of_another(call: Call, tmp_path: Path) -> None:
    assert call("follow", "mine.yaml", "--out", "ahead")[0] == 0
    code, message, complaint = call("follow-vehicle", "ahead/path.parquet", "--behind", "4", "--out", "out")
    assert (code, complaint) == (0, "")
    assert "gap error" in message
    assert "note" not in message
    assert check_dataset(tmp_path / "out") == []


def test_a_vehicle_faster_than_the_boat_is_reported(call: Call, tmp_path: Path) -> None:
    assert call("follow", "mine.yaml", "--out", "ahead")[0] == 0
    sizes = ("--length", 0.6, "--breadth", 0.3, "--mass", 8, "--thrust", 2)
    assert call("boat", "new", "toy", "--kind", "azimuth", *sizes)[0] == 0
    follow = ("follow-vehicle", "ahead/path.parquet", "--behind", "4", "--boat", "toy.yaml", "--out", "out")
    code, message, _ = call(*follow)
    assert code == 0
    assert "note: the vehicle moves at 0.8" in message
    assert "the boat's top speed in still water" in (tmp_path / "out/analysis/report.md").read_text()


def test_a_run_of_it_replays_to_itself(call: Call, tmp_path: Path) -> None:
    assert call("follow", "mine.yaml", "--out", "out")[0] == 0
    assert call("simulate", "--commands", "out/path.parquet", "--out", "again.csv")[0] == 0
    with (tmp_path / "out/analysis/track.csv").open() as first, (tmp_path / "again.csv").open() as second:
        ends = [list(csv.DictReader(file))[-1] for file in (first, second)]
    assert float(ends[0]["north"]) == pytest.approx(float(ends[1]["north"]), abs=1e-3)


def test_a_station_is_held_and_one_that_cannot_be_is_refused(call: Call, tmp_path: Path) -> None:
    code, message, _ = call("hold", "--duration", 20, "--current", 0.2, "--wind", 4, "--out", "out")
    assert code == 0
    assert "can hold at heading" in message
    assert "\nheld: for 95 % of the time" in message
    assert json.loads((tmp_path / "out/analysis/result.json").read_text())["held"]
    assert check_dataset(tmp_path / "out") == []
    assert_complains(call("hold", "--current", 5, "--out", "far"), "cannot hold")
    assert_complains(call("hold", "--boat", "esso_osaka", "--out", "far"), "bow in a current or wind")
    assert_complains(call("hold", "--failed", "xx", "--out", "far"), "xx")
    assert_complains(call("hold", "--heading", 400, "--out", "far"), "--heading")
    assert_complains(call("hold", "--current", "nan", "--out", "far"), "current")
    for verb in (["hold"], ["follow", "eight"], ["follow-vehicle", "run.csv", "--behind", "5"]):
        assert_complains(call(*verb, "--current", "400", "--out", "far"), "--current", "at most 20")
        assert_complains(call(*verb, "--wind", "inf", "--out", "far"), "--wind", "at most 60")
    assert not (tmp_path / "far").exists()


def test_a_station_that_is_lost_in_gusts_ends_with_that_verdict(call: Call, tmp_path: Path) -> None:
    failed = ("--failed", "bs", "--failed", "bp", "--failed", "sp")
    sea = ("--current", 0.3, "--wind", 4, "--disturbances", "standard")
    code, message, _ = call("hold", *failed, *sea, "--out", "out")
    with (tmp_path / "out/analysis/track.csv").open() as file:
        late = [float(row["distance"]) for row in csv.DictReader(file) if float(row["time"]) >= 30.0]
    near = sum(distance < 1.24 for distance in late) / len(late)
    assert code == 0 and near < 0.95
    assert "\nnot held: for less than 95 % of the time" in message
    assert "not held" in (tmp_path / "out/analysis/report.md").read_text()


def test_what_cannot_be_followed_leaves_nothing(call: Call, tmp_path: Path) -> None:
    assert_complains(call("follow", "eihgt", "--out", "out"), "eight")
    (tmp_path / "fast.yaml").write_text(MINE.replace("0.8", "5.0"))
    assert_complains(call("follow", "fast.yaml", "--out", "out"), "fast.yaml", "speed")
    assert_complains(call("follow", "mine.yaml", "--wind-from", 500, "--out", "out"), "--wind-from")
    assert_complains(call("follow-vehicle", "none.csv", "--behind", 2, "--out", "out"), "none.csv")
    assert not (tmp_path / "out").exists()


def test_a_capability_plot_holds_a_row_for_each_direction(call: Call, tmp_path: Path) -> None:
    code, message, complaint = call("capability", "swamp", "--failed", "bs", "--out", "out")
    assert (code, complaint) == (0, "")
    assert "wind [m/s]" in message
    data = json.loads((tmp_path / "out/capability.json").read_text())
    with (tmp_path / "out/capability.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["wind"]) for row in rows] == pytest.approx(data["wind"], rel=1e-6)
    assert len(rows) == 36
    assert (tmp_path / "out/capability.png").is_file()


def test_a_wind_that_is_the_greatest_tried_is_reported_as_such(call: Call) -> None:
    sizes = ("--length", 15, "--breadth", 5, "--mass", 40000, "--thrust", 60000)
    call("boat", "new", "tug", "--kind", "azimuth", *sizes)
    message = call("capability", "tug.yaml", "--out", "out")[1]
    assert "wind [m/s]: from ahead at least 60.00, least 4" in message
    assert "current [m/s]: from ahead 5.1" in message
