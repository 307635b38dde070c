"""`swamp-rl mission`: the chain from a file to its folder, and nothing written where it is refused."""

import csv
import json
import re
from pathlib import Path

import pytest
from swamp_rl.experiments.artifacts.stages import stages

from swamp_rl.replacement import WRITTEN
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

MINE = "name: mine\nboat: swamp\ncharge: {charge}\nlegs: [{{speed: 0.9, duration_s: 40.0}}]\n"


@pytest.fixture(autouse=True)
def _mission(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(MINE.format(charge=1.0))
    (tmp_path / "low.yaml").write_text(MINE.format(charge=0.101))


def test_a_mission_writes_report_figure_rows_and_figures(call: Call, tmp_path: Path) -> None:
    code, message, complaint = call("mission", "mine.yaml", "--out", "out folder")
    assert (code, complaint) == (0, "")
    assert "state of charge at the end: starboard 0.99" in message
    out = tmp_path / "out folder"
    assert {path.name for path in out.iterdir()} == {
        WRITTEN,
        "report.md",
        "mission.json",
        "mission.csv",
        "mission.png",
    }
    data = json.loads((out / "mission.json").read_text())
    with (out / "mission.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 41
    assert float(rows[-1]["charge_port"]) == pytest.approx(data["charge"][1], abs=1e-8)
    assert data["legs"][0]["distance"] == pytest.approx(data["distance"])
    of_jets = [float(rows[-1][f"thruster_power_{name}"]) for name in ("bs", "ss")]
    assert float(rows[-1]["power_starboard"]) == pytest.approx(sum(of_jets) + 88.0)  # the hotel load
    assert call("mission", "mine.yaml", "--out", "out folder")[0] == 0  # its own result may be replaced


def test_without_a_folder_nothing_is_written(call: Call, tmp_path: Path) -> None:
    assert call("mission", "mine.yaml")[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"mine.yaml", "low.yaml"}


def test_a_refused_mission_leaves_nothing(call: Call, tmp_path: Path) -> None:
    assert_complains(call("mission", "low.yaml", "--out", "out"), "low.yaml", "--even-if-empty")
    assert_complains(call("mission", "mine.yaml", "--out", "out", "--boat", "esso_osaka"), "power")
    assert_complains(call("mission", "survye"), "survey")
    assert {path.name for path in tmp_path.iterdir()} == {"mine.yaml", "low.yaml"}
    code, _, _ = call("mission", "low.yaml", "--out", "out", "--even-if-empty")
    assert code == 0
    assert (tmp_path / "out" / "report.md").is_file()


@pytest.mark.parametrize("boat", ["../../evil.yaml", "swmap", ""])
def test_a_boat_that_the_file_names_and_that_is_not_there_is_reported_by_file_and_key(
    boat: str, call: Call, tmp_path: Path
) -> None:
    (tmp_path / "odd.yaml").write_text(MINE.replace("swamp", f'"{boat}"').format(charge=1.0))
    assert_complains(call("mission", "odd.yaml"), "odd.yaml: boat: ")
    (tmp_path / "plan.yaml").write_text(
        f'boat: "{boat}"\nname: p\ntrials: [{{manoeuvre: stopping, throttle: [0.6]}}]\n'
    )
    assert_complains(call("trial", "plan", "plan.yaml", "--out", "out"), "plan.yaml: boat: ")
    assert not (tmp_path / "out").exists()


def test_a_folder_of_something_else_is_not_replaced(call: Call, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "diary.txt").write_text("mine")
    assert_complains(call("mission", "mine.yaml", "--out", "out"), "already exists")
    assert (tmp_path / "out" / "diary.txt").read_text() == "mine"


def test_markup_of_a_mission_file_is_text_in_its_report(call: Call, tmp_path: Path) -> None:
    hostile = "<img src=x onerror=alert(1)> ![](http://example.org/seen.png) |`a`|"
    text = MINE.format(charge=1.0) + f"description: |\n  {hostile}\n\n  # a heading\n"
    (tmp_path / "mine.yaml").write_text(text)
    assert call("mission", "mine.yaml", "--out", "out")[0] == 0
    (line,) = [one for one in (tmp_path / "out/report.md").read_text().splitlines() if "onerror" in one]
    assert line.startswith("Simulated. \\<img") and line.endswith("# a heading")
    assert re.findall(r"(?<!\\)[<>|`\[\]]", line) == []


def test_a_stage_named_with_markup_of_the_terminal_is_shown_as_it_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    with stages() as progress, progress.stage("try one, [red]calm"):
        pass
    assert "[red]calm" in capsys.readouterr().err
