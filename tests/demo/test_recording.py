"""The rerun recording: readable, whole, one timeline for all who drove."""

import gc
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.course import load_course
from swamp_rl.demo import recording
from swamp_rl.demo.layout import ASPECT, FIELD, eye
from swamp_rl.demo.markdown import about, table
from swamp_rl.demo.recording import recorded, write_recording
from swamp_rl.demo.scene import DemoScene, demo_scene
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, RunMeta

TIME = np.arange(120) * 0.1
CURRENT = [{"effect": "current", "north": 0.1, "east": 0.2}, {"effect": "wind", "speed": 3.0, "from": 0.5}]


def run(speed: float, name: str = "a") -> Run:
    columns = {"time": TIME + 5.0, "north": speed * TIME, "east": 0 * TIME, "heading": 0 * TIME}
    levers = {"joy_thrust": np.ones(120), "joy_angle": np.sin(TIME)}
    return Run(name, columns | levers, RunMeta(disturbances=CURRENT))


def scene(names: dict[str, int]) -> DemoScene:
    runs = {who: [run(0.5 + 0.1 * i, f"{who}-{i}") for i in range(count)] for who, count in names.items()}
    return demo_scene("race", runs, load_course("camogli"), (1.24, 1.1))


def rrd(command: str, path: Path) -> str:
    asked = [sys.executable, "-m", "rerun", "rrd", *command.split("|"), str(path)]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("demo") / "demo.rrd"
    write_recording(path, scene({"scripted": 1, "reservoir": 2}))
    return path


def test_the_recording_can_be_read_and_nothing_is_left_beside_it(demo: Path) -> None:
    rrd("verify", demo)
    assert [found.name for found in demo.parent.iterdir()] == ["demo.rrd"]


def test_all_drivers_are_in_one_recording_over_one_timeline_that_starts_at_zero(demo: Path) -> None:
    recordings = set()
    for who in ("scripted", "reservoir"):
        printed = rrd(rf"print|-vvv|--entity|/series/angle\ lever\ \[1\]/{who}", demo)
        assert "index_name: time " in printed
        assert " P0D " in printed and " PT11.9S " in printed and " PT12S " not in printed
        recordings |= set(re.findall(r'Recording,\s+"swamp_rl",\s+"([^"]*)"', printed))
    assert recordings == {"race"}


def test_tracks_boats_series_wind_current_and_gates_are_there_in_two_and_three_dimensions(demo: Path) -> None:
    listed = rrd("stats", demo)
    for who in ("scripted", "reservoir"):
        for what in ("boat", "track", "whole_track", "name", "wind", "current"):
            assert f"/chart/runs/{who}/{what}:" in listed
        for what in ("boat", "track"):
            assert f"/space/runs/{who}/{what}:" in listed
        for panel in (
            "throttle\\ lever",
            "angle\\ lever",
            "speed\\ over\\ ground",
            "distance\\ to\\ go",
            "wind",
        ):
            assert re.search(rf"/series/{re.escape(panel)}\S* ?\S*/{who}:", listed), panel
    for gate in ("green", "red"):
        for root in ("chart", "space"):
            assert f"/{root}/course/gates/{gate}/buoys:" in listed


def test_all_that_is_sailed_is_in_view_of_the_camera_and_fills_it() -> None:
    for north, east in ((1.0, 0.0), (0.0, 3.0), (2.0, 2.0)):
        columns = {"time": TIME, "north": north * TIME, "east": east * TIME, "heading": 0 * TIME}
        shown = demo_scene("a", {"x": [Run("a", columns)]}, load_course("camogli"), (1.24, 1.1))
        position, target = eye(shown)
        ahead = (target - position) / np.linalg.norm(target - position)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        flat = np.vstack([shown.shown[0].run.pose[:, :2], shown.buoys])[:, ::-1]
        off = np.column_stack([flat, np.zeros(len(flat))]) - position
        across, above = (off @ axis / (off @ ahead) for axis in (right, np.cross(right, ahead)))
        half = np.tan(0.5 * FIELD)
        assert position[2] > 0.0 and (off @ ahead > 0.0).all()
        assert np.abs(above).max() < half and np.abs(across).max() < ASPECT * half
        assert max(np.ptp(above) / (2.0 * half), np.ptp(across) / (2.0 * ASPECT * half)) > 0.6


def test_from_its_end_on_the_recording_tells_what_came_of_each_run(demo: Path) -> None:
    printed = rrd("print|-vvv|--entity|/result", demo)
    assert " P0D " in printed and " PT11.9S " in printed
    shown = scene({"scripted": 1, "reservoir": 2, "a|b\n*c*": 1})
    result = table(shown).splitlines()
    assert [line.count(" | ") for line in result] == [5] * 6
    assert result[2].startswith("| scripted |") and result[-1].startswith(r"| a\|b \*c\* |")
    assert "different weather" in about(shown)


def test_many_runs_stay_few_pieces_with_whole_tracks(tmp_path: Path) -> None:
    write_recording(tmp_path / "many.rrd", scene({"scripted": 15, "ppo": 15}), "side-by-side")
    listed = rrd("stats", tmp_path / "many.rrd")
    assert "/chart/runs/ppo/whole_track:" in listed and "/space/runs/ppo/whole_track:" in listed
    assert "/chart/runs/ppo/track:" not in listed
    assert len(re.findall(r"^/(?:chart|space|series)\S*", listed, re.MULTILINE)) < 50


def test_an_interrupted_recording_is_dropped_without_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*result: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(recording, "_log_result", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_recording(tmp_path / "a.rrd", scene({"scripted": 1}))
    gc.collect()
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []


def test_names_with_any_characters_can_be_recorded(tmp_path: Path) -> None:
    odd = {'a/b <i>"c"</i> \\ é\n': 2, "**": 1, " ": 1}
    (tmp_path / "odd.rrd").write_bytes(recorded(scene(odd), "side-by-side"))
    rrd("verify", tmp_path / "odd.rrd")


def test_a_recording_that_cannot_be_written_says_so_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "demo.rrd").mkdir()
    with pytest.raises(UserError) as error:
        write_recording(tmp_path / "demo.rrd", scene({"a": 1}))
    assert "\n" not in str(error.value)


def test_a_recording_for_which_the_disk_has_no_room_leaves_no_file(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
    try:
        with pytest.raises(UserError, match="too large"):
            write_recording(tmp_path / "demo.rrd", scene({"a": 1}))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []
