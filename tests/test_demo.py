"""The rerun recording: readable, whole, one timeline for all who drove."""

import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.course import load_course
from swamp_rl.demo.recording import write_demo
from swamp_rl.errors import UserError
from swamp_rl.runs import Run

TIME = np.arange(120) * 0.1


def run(speed: float) -> Run:
    columns = {"time": TIME + 5.0, "north": speed * TIME, "east": 0 * TIME, "heading": 0 * TIME}
    return Run("a", columns | {"joy_thrust": np.ones(120), "joy_angle": np.sin(TIME)})


def rrd(command: str, path: Path) -> str:
    asked = [sys.executable, "-m", "rerun", "rrd", *command.split(), str(path)]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("demo") / "demo.rrd"
    write_demo(path, load_course("camogli"), {"scripted": run(0.5), "reservoir": run(0.7)}, 1.24, 1.1)
    return path


def test_the_recording_can_be_read_and_nothing_is_left_beside_it(demo: Path) -> None:
    rrd("verify", demo)
    assert [found.name for found in demo.parent.iterdir()] == ["demo.rrd"]


def test_both_pilots_are_in_one_recording_over_one_timeline_that_starts_at_zero(demo: Path) -> None:
    recordings = set()
    for who in ("scripted", "reservoir"):
        printed = rrd(f"print -vvv --entity /levers/angle/{who}", demo)
        assert "index_name: time " in printed
        assert " P0D " in printed and " PT11.9S " in printed and " PT12S " not in printed
        recordings |= set(re.findall(r'Recording,\s+"swamp_rl",\s+"([^"]*)"', printed))
    assert recordings == {"camogli: scripted, reservoir"}


def test_tracks_boats_levers_gates_and_start_are_all_there(demo: Path) -> None:
    listed = rrd("stats", demo)
    for who in ("scripted", "reservoir"):
        for what in ("chart/{}/track", "chart/{}/boat", "levers/throttle/{}", "levers/angle/{}"):
            assert f"/{what.format(who)}:" in listed
    for gate in ("green", "red"):
        assert f"/chart/gates/{gate}/buoys:" in listed


def test_a_recording_that_cannot_be_written_says_so_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "demo.rrd").mkdir()
    with pytest.raises(UserError) as told:
        write_demo(tmp_path / "demo.rrd", load_course("camogli"), {"a": run(1.0)}, 1.24, 1.1)
    assert "\n" not in str(told.value)


def test_a_recording_for_which_the_disk_has_no_room_leaves_no_file(tmp_path: Path) -> None:
    course, before = load_course("camogli"), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
    try:
        with pytest.raises(UserError, match="too large"):
            write_demo(tmp_path / "demo.rrd", course, {"a": run(1.0)}, 1.24, 1.1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []
