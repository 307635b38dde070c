"""The doctor reads datasets, plain folders, LeRobot's and Minari's, and refuses what is none in one line."""

import json
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from swamp_rl.boat import Boat
from swamp_rl.doctor.read import read_records
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.export_dataset import export_runs
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.runs import circling, described


@pytest.mark.parametrize(("to", "layout"), [("lerobot", "LeRobot"), ("minari", "Minari"), ("csv", "dataset")])
def test_each_layout_gives_the_same_runs(folder: Path, tmp_path: Path, to: str, layout: str) -> None:
    if to == "minari":
        pytest.importorskip("minari", reason="minari is not installed; its folders are not tested")
    export_runs(folder, to, tmp_path / "out", None)
    found = read_records(tmp_path / "out")
    assert found.layout == layout and found.boat is not None and found.boat.name == "swamp"
    for run, was in zip(found.runs, read_dataset(folder).runs, strict=True):
        for name in ("time", "north", "heading", "azimuth_bs"):
            assert run.columns[name] == pytest.approx(was.columns[name], abs=1e-6)


def exported(folder: Path, to: str) -> Boat:
    """The boat, of a file of its own, of a dataset that is exported to `out`."""
    (folder / "mine.yaml").write_text("extends: swamp\nname: mine\nmass: 60.0\n")
    create_dataset(folder / "runs", described(vehicle=str(folder / "mine.yaml")))
    append_run(folder / "runs", Run("one", circling()))
    export_runs(folder / "runs", to, folder / "out", None)
    return read_dataset(folder / "runs").boat


@pytest.mark.parametrize("to", ["lerobot", "minari"])
def test_the_boat_of_an_export_is_the_one_that_it_carries(tmp_path: Path, to: str) -> None:
    if to == "minari":
        pytest.importorskip("minari", reason="minari is not installed; its folders are not tested")
    wanted = exported(tmp_path, to)
    assert read_records(tmp_path / "out").boat == wanted
    named = read_records(tmp_path / "out", "swamp").boat
    assert named is not None and named.name == "swamp"


def test_a_damaged_boat_of_a_minari_export_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("minari", reason="minari is not installed; its folders are not tested")
    exported(tmp_path, "minari")
    (meta,) = (tmp_path / "out").rglob("metadata.json")
    data = json.loads(meta.read_text())
    for copies, about in (('{"mine.yaml": "name: 3"}', data["swamp_rl"]), (data["swamp_rl_copies"], "{}")):
        meta.write_text(json.dumps({**data, "swamp_rl_copies": copies, "swamp_rl": about}))
        with pytest.raises(UserError, match="its boat cannot be read") as refused:
            read_records(tmp_path / "out")
        assert "\n" not in str(refused.value)


def test_a_plain_folder_needs_no_boat(folder: Path) -> None:
    (folder / "dataset.yaml").unlink()
    found = read_records(folder)
    assert (found.layout, found.boat, len(found.runs)) == ("folder of tables", None, 2)
    boat = read_records(folder, "swamp").boat
    assert boat is not None and boat.name == "swamp"


def test_the_verb_prints_findings_or_json_and_its_status_tells(call: Call, folder: Path) -> None:
    code, message, _ = call("runs", "doctor", folder)
    assert code == 0 and "0 faults" in message
    (folder / "dataset.yaml").unlink()
    table = (folder / "one.csv").read_text().splitlines()
    table[5] = table[4]
    (folder / "one.csv").write_text("\n".join(table) + "\n")
    code, message, _ = call("runs", "doctor", folder, "--json")
    data = json.loads(message)
    assert code == 1 and "time_repeated" in [finding["code"] for finding in data["findings"]]
    assert data["findings"][0]["runs"] == ["one"]


def test_each_of_several_folders_is_examined_by_itself(call: Call, tmp_path: Path, sound: list[Run]) -> None:
    """Together the sound runs of one day would hide that the commands are exchanged in those of the other."""
    sides = ["throttle_port", "throttle_starboard"]
    for day, order in (("may", sides), ("june", sides[::-1])):
        (tmp_path / day).mkdir()
        for run in sound:
            columns = dict(run.columns) | dict(zip(order, (run.columns[side] for side in sides), strict=True))
            pq.write_table(pa.table(columns), tmp_path / day / f"{run.name}.parquet")
    code, message, _ = call("runs", "doctor", "may", "june")
    may, june = message.split("\n\n")
    assert code == 1
    assert "commands_exchanged" not in may and "\nmay (folder of tables): 3 runs" in f"\n{may}"
    assert "commands_exchanged" in june and "\njune (folder of tables): 3 runs" in june
    code, message, _ = call("runs", "doctor", "may", "june", "--json")
    assert code == 1 and [one["folder"] for one in json.loads(message)] == ["may", "june"]


def test_a_table_without_rows_is_reported_and_an_empty_time_leaves_the_findings_valid_json(
    call: Call, folder: Path
) -> None:
    (folder / "dataset.yaml").unlink()
    lines = (folder / "one.csv").read_text().splitlines()
    (folder / "none.csv").write_text(lines[0] + "\n")
    lines[5] = lines[5][lines[5].index(",") :]
    (folder / "one.csv").write_text("\n".join(lines) + "\n")
    code, message, _ = call("runs", "doctor", folder, "--json")
    data = json.loads(message)
    assert code == 1
    assert "time_jump" in [finding["code"] for finding in data["findings"]]
    assert any(line.startswith("none.csv: holds no rows") for line in data["format_faults"])


@pytest.mark.parametrize("cell", ["", "left"])
def test_a_command_without_a_number_is_not_examined(call: Call, tmp_path: Path, cell: str) -> None:
    rows = [f"{0.1 * i:.1f},{0.1 * i:.1f},0,0,{cell},{0.01 * i:.2f}" for i in range(50)]
    text = "\n".join(["time,north,east,heading,throttle_port,throttle_starboard", *rows])
    (tmp_path / "run.csv").write_text(text + "\n")
    code, message, _ = call("runs", "doctor", tmp_path)
    assert code == 1 and "column throttle_port: " in message and "Traceback" not in message


def test_a_table_without_times_is_reported_and_left_out(call: Call, folder: Path) -> None:
    (folder / "dataset.yaml").unlink()
    (folder / "two.csv").write_text("north,east\n" + "1,2\n" * 50)
    code, message, _ = call("runs", "doctor", folder)
    assert code == 1 and "two.csv: has no column time" in message
    for path in set(folder.iterdir()) - {folder / "two.csv"}:
        path.unlink()
    assert_complains(call("runs", "doctor", folder), "two.csv: has no column time")


def test_rows_of_no_episode_are_reported_and_left_out(tmp_path: Path) -> None:
    for name in ("meta", "data"):
        (tmp_path / name).mkdir()
    (tmp_path / "meta" / "info.json").write_text('{"fps": 10, "features": {}}')
    frames = {"episode_index": pa.array([0, None, 1]), "timestamp": [0.0, 0.1, 0.0], "north": [0.0, 1.0, 2.0]}
    pq.write_table(pa.table(frames), tmp_path / "data" / "file.parquet")
    found = read_records(tmp_path)
    assert [run.name for run in found.runs] == ["episode-0", "episode-1"]
    assert found.faults == ["file.parquet: 1 rows have no episode_index; they are left out"]


def test_what_is_no_folder_of_runs_is_one_line(call: Call, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert_complains(call("runs", "doctor", tmp_path / "empty"), "no runs here")
    assert_complains(call("runs", "doctor", tmp_path / "nowhere"), "no such folder")


def test_a_lerobot_folder_without_its_data_is_reported_as_such_and_not_imported(
    call: Call, tmp_path: Path
) -> None:
    (tmp_path / "arm" / "meta").mkdir(parents=True)
    (tmp_path / "arm" / "meta" / "info.json").write_text('{"fps": 10, "features": {}}')
    assert_complains(call("runs", "doctor", "arm"), "its data has no .parquet file")
    assert_complains(call("runs", "import", "arm", "--out", "a"), "a folder of LeRobot or Minari")
    assert not Path("a").exists()


def test_a_folder_of_something_else_than_boats_is_a_fault_and_not_sound(call: Call, tmp_path: Path) -> None:
    rows = "".join(f"{0.1 * i:.1f},{i},{i % 7}\n" for i in range(60))
    (tmp_path / "cart.csv").write_text("time,angle,action\n" + rows)
    code, message, _ = call("runs", "doctor", tmp_path)
    assert code == 1
    assert "columns_missing: north, east, heading: in no run, which have time, angle, action" in message


@pytest.mark.parametrize("text", ["", "[]", "{", '{"features": 3, "fps": "x"}'])
def test_a_damaged_lerobot_folder_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "meta").mkdir()
    (tmp_path / "data").mkdir()
    (tmp_path / "meta" / "info.json").write_text(text)
    (tmp_path / "data" / "file.parquet").write_bytes(b"PAR1 not at all")
    with pytest.raises(UserError) as error:
        read_records(tmp_path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["one.csv", "meta/info.json", "data/main_data.hdf5"])
def test_a_link_in_a_folder_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "runs" / name
    path.parent.mkdir(parents=True)
    (tmp_path / "elsewhere").write_text("time,north\n")
    path.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(UserError, match="is a link"):
        read_records(tmp_path / "runs")


@pytest.mark.parametrize("held", [b"", b"\x89HDF\r\n\x1a\n" + b"\0" * 200])
def test_a_damaged_minari_file_is_one_line(tmp_path: Path, held: bytes) -> None:
    pytest.importorskip("h5py", reason="h5py is not installed; Minari's folders are not tested")
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "main_data.hdf5").write_bytes(held)
    with pytest.raises(UserError, match="not a complete Minari file"):
        read_records(tmp_path)
