"""`swamp-rl identify waypoint-square`."""

import json
from pathlib import Path

from swamp_rl.files import find_config
from swamp_rl.replacement import WRITTEN
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture


def test_a_square_is_identified_replayed_and_drawn(call: Call, tmp_path: Path) -> None:
    code, message, complaint = call("identify", "waypoint-square", "typhoon", "--out", "out")
    assert (code, complaint) == (0, "")
    assert "replay: mean track error" in message
    data = json.loads((tmp_path / "out/result.json").read_text())
    assert data["axes"]["surge"]["shown"]
    assert data["track_error"]["mean"] <= data["track_error"]["rms"] <= data["track_error"]["max"]
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {WRITTEN, "report.md", "result.json", "square.png"}


def test_what_is_not_shown_is_said_and_bad_files_are_refused(call: Call, tmp_path: Path) -> None:
    text = find_config("vehicles", "typhoon").read_text()
    (tmp_path / "flat.yaml").write_text(text.replace("depth: {value: 3.0", "depth: {value: 0.0"))
    code, message, _ = call("identify", "waypoint-square", "flat.yaml", "--out", "flat")
    assert code == 0
    assert "not identifiable: heave: no elementary heave motion" in message
    (tmp_path / "bad.yaml").write_text(text.replace("surge_mass: {value: 180.0", "surge_mass: {value: -1.0"))
    assert_complains(
        call("identify", "waypoint-square", "bad.yaml", "--out", "bad"), "bad.yaml", "surge_mass"
    )
    assert_complains(call("identify", "waypoint-square", "typhon", "--out", "bad"), "typhoon")
    assert not (tmp_path / "bad").exists()
