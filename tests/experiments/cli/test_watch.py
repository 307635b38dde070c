"""`swamp-rl watch`: a recorded fault named line by line, and what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.runs import Run
from swamp_rl.runs.mcap_files import write_mcap
from swamp_rl.runs.schema import meta_of
from swamp_rl.simulator.sensors import CHANNELS
from tests.support.binary_logs import bag as ros_bag
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import written
from tests.support.live_stream import BOAT, DT, stream

BEGINS = 40.0
FAILURE = {"effect": "thruster_failure", "thruster": "bp", "time": 0.0}


def recorded(path: Path, seconds: float) -> Path:
    """A run in which a thruster fails, as an MCAP file."""
    samples = list(stream(seconds, BEGINS, [FAILURE]))
    senses, commands = np.array([s.senses for s in samples]), np.array([s.commands for s in samples])
    columns = {"time": np.array([s.time for s in samples])} | dict(zip(CHANNELS, senses.T, strict=True))
    names = [f"azimuth_{name}" for name in BOAT.thruster_names]
    names += [f"throttle_{name}" for name in BOAT.thruster_names]
    columns |= dict(zip(names, commands.T, strict=True))
    meta = meta_of(BOAT, "swamp", 1 / DT, "scripted")
    write_mcap(path, Run("run", columns), meta)
    return path


def test_a_recorded_failure_is_named(call: Call, tmp_path: Path) -> None:
    recorded(tmp_path / "run.mcap", BEGINS + 5.0)
    code, message, complaint = call("watch", "--mcap", "run.mcap")
    assert (code, complaint) == (0, "")
    assert "monitoring" in message.splitlines()[0]
    assert re.search(r"thruster_failure bp \(time [\d.]+ s\), since", message.splitlines()[1])
    assert message.splitlines()[-1].endswith("samples, notices: 1")


def test_a_file_is_watched_with_the_boat_that_it_carries(call: Call, tmp_path: Path) -> None:
    written(tmp_path, "twin")
    turning = ["--angle", 30, "--throttle", 0.6, "--turns", 2, "--out", "sea"]
    assert call("trial", "turning-circle", "--boat", "twin.yaml", *turning)[0] == 0
    assert call("runs", "export", "sea", "--to", "mcap", "--out", "exported")[0] == 0
    (tmp_path / "twin.yaml").unlink()
    file = next(Path("exported").glob("*.mcap"))
    code, message, complaint = call("watch", "--mcap", file)
    assert (code, complaint) == (0, "") and "monitoring" in message
    assert_complains(call("watch", "--mcap", file, "--boat", "swamp"), "name the boat of this run by --boat")


def test_a_program_reads_it_as_json_lines(call: Call, tmp_path: Path) -> None:
    recorded(tmp_path / "run.mcap", BEGINS + 5.0)
    code, message, _ = call("watch", "--mcap", "run.mcap", "--json")
    notices = [json.loads(line) for line in message.splitlines()]
    assert code == 0
    assert [notice["cause"] for notice in notices] == ["thruster_failure bp"]
    assert notices[0]["since"] == pytest.approx(BEGINS, abs=0.6)


def test_what_cannot_be_watched_is_refused_in_one_line(call: Call, tmp_path: Path) -> None:
    pytest.importorskip("rosbags", reason="rosbags is not installed; a ROS bag is not tried")
    recorded(tmp_path / "short.mcap", 12.0)
    (tmp_path / "run.csv").write_text("time\n0\n")
    assert_complains(call("watch"), "--link", "--mcap")
    assert_complains(call("watch", "--mcap", "short.mcap", "--link", "127.0.0.0/24"), "either")
    assert_complains(call("watch", "--mcap", "run.csv"), "run.csv", "export")
    assert_complains(call("watch", "--mcap", "short.mcap"), "30 s")
    assert_complains(call("watch", "--mcap", "absent.mcap"), "absent.mcap")
    (bag,) = ros_bag(tmp_path / "bag", "mcap", 2.0).glob("*.mcap")
    assert_complains(call("watch", "--mcap", bag), "has no JSON messages, but", "runs export --to mcap")
    assert_complains(call("watch", "--mcap", "short.mcap", "--boat", "swmap"), "swamp")


def test_a_file_that_is_still_being_written_is_refused_as_such(call: Call, tmp_path: Path) -> None:
    whole = recorded(tmp_path / "run.mcap", 5.0).read_bytes()
    for length in (0, 100, len(whole) // 2):
        (tmp_path / "run.mcap").write_bytes(whole[:length])
        result = call("watch", "--mcap", "run.mcap")
        assert_complains(result, "run.mcap: the end of the MCAP file is missing; wait if it")


def test_a_run_of_another_boat_is_refused_in_one_line(call: Call, tmp_path: Path) -> None:
    recorded(tmp_path / "run.mcap", 5.0)
    result = call("watch", "--mcap", "run.mcap", "--boat", "esso_osaka")
    assert_complains(
        result, "by which boat esso_osaka is commanded, is missing; name the boat of this run by --boat"
    )
    assert result[2].count("\n") == 1
