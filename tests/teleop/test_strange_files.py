"""Links, pipes and second names in a folder of runs: a recorder neither follows nor waits for them."""

import os
from contextlib import suppress
from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.teleop.recordings import Recordings
from tests.support.driving import meta, recordings


def test_links_in_a_folder_of_runs_lead_a_recorder_nowhere(tmp_path: Path) -> None:
    victim = tmp_path / "victim.csv"
    victim.write_text("time\n1\n2\n3")
    recordings(tmp_path / "runs").close()
    unfinished = tmp_path / "runs" / "unfinished"
    (unfinished / "run-0001.json").write_text("{}")
    (unfinished / "run-0001.csv").symlink_to(victim)
    lines: list[str] = []
    Recordings(tmp_path / "runs", meta(), lines.append).close()
    assert len(lines) == 1 and "is a link" in lines[0]
    (unfinished / ".lock").unlink()
    (unfinished / ".lock").symlink_to(victim)
    with pytest.raises(UserError):
        recordings(tmp_path / "runs")
    assert victim.read_text() == "time\n1\n2\n3"


def test_another_name_of_an_unfinished_table_keeps_its_bytes(tmp_path: Path) -> None:
    victim = tmp_path / "victim.csv"
    victim.write_text("time\n1\n2\n3")
    recordings(tmp_path / "runs").close()
    unfinished = tmp_path / "runs" / "unfinished"
    (unfinished / "run-0001.json").write_text("{}")
    (unfinished / "run-0001.csv").hardlink_to(victim)
    (unfinished / ".lock").unlink()
    (unfinished / ".lock").hardlink_to(victim)
    recordings(tmp_path / "runs").close()
    assert victim.read_text() == "time\n1\n2\n3"


@pytest.mark.parametrize("name", ["run-0001.csv", "run-0001.json", ".lock"])
def test_a_recorder_does_not_wait_for_a_pipe(tmp_path: Path, name: str) -> None:
    recordings(tmp_path / "runs").close()
    unfinished = tmp_path / "runs" / "unfinished"
    (unfinished / "run-0001.json").write_text("{}")
    (unfinished / name).unlink(missing_ok=True)
    os.mkfifo(unfinished / name)
    with suppress(UserError):
        recordings(tmp_path / "runs").close()
