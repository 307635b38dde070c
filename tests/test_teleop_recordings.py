"""Nothing that was accepted is ever lost; what was not is there, marked, after any crash."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import check_dataset, read_dataset
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.rows import largest_difference
from swamp_rl.teleop.session import RUN
from tests.driving import BOAT, accept, command, drive, meta, recordings, session

# Drives without end, and says after each accepted run that it was.
RECORDER = """
import sys
from pathlib import Path
from tests.driving import accept, drive, session
game = session(Path(sys.argv[1]), "standard")
now = 0.0
print("ready", flush=True)
while True:
    now = drive(game, now)
    if game.journal is None:
        game.drop(again=False)
    else:
        print("accepted", accept(game), flush=True)
"""


def killed(folder: Path, after: float) -> list[str]:
    """Names of the runs that a recorder acknowledged until, after some time [s], it was killed."""
    start = [sys.executable, "-c", RECORDER, str(folder)]
    process = subprocess.Popen(start, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(after)
    process.send_signal(signal.SIGKILL)
    out, _ = process.communicate(timeout=20)
    return [line.split()[1] for line in out.splitlines()]


@pytest.mark.parametrize("after", [0.9, 1.45])
def test_a_kill_at_any_instant_loses_no_accepted_run_and_marks_the_unfinished_one(
    tmp_path: Path, after: float
) -> None:
    folder = tmp_path / "runs"
    acknowledged = killed(folder, after)
    heard: list[str] = []
    Recordings(folder, meta(), heard.append).close()
    # Killed before the first run was ended, there may be nothing at all.
    runs = read_dataset(folder).runs if acknowledged or heard else []
    assert {run.name for run in runs} >= set(acknowledged)
    assert check_dataset(folder) == [] or not runs
    assert len([run for run in runs if run.meta.outcome == "interrupted"]) <= 1
    for run in runs[-2:]:
        assert largest_difference(run, BOAT) == 0.0
    assert list((folder / "unfinished").glob("run-*")) == []


def test_an_unfinished_run_is_on_the_disk_row_by_row_and_taken_in_as_interrupted(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    now = 0.0
    while game.phase != RUN or game.rows < 12:
        game.command(command(game), now)
        now += 0.05
    assert game.journal is not None
    game.journal.sync()
    table = tmp_path / "runs" / "unfinished" / "run-0001.csv"
    assert len(table.read_text().splitlines()) == 13
    # The recorder vanishes while a row is being written.
    game.recordings.close()
    with table.open("a") as file:
        file.write("11.4,0.33,1")
    heard: list[str] = []
    found = Recordings(tmp_path / "runs", meta(), heard.append)
    run = found.read("run-0001")
    assert len(run.time) == 12
    assert run.meta.outcome == "interrupted"
    assert found.count == 0 and found.board == []
    assert largest_difference(run, BOAT) == 0.0
    assert "never finished" in heard[0]


@pytest.mark.parametrize("renamed", [False, True])
def test_a_run_accepted_but_not_yet_listed_is_listed(tmp_path: Path, renamed: bool) -> None:
    folder = tmp_path / "runs"
    game = session(folder)
    drive(game)
    about = game.about()
    assert game.journal is not None
    game.journal.describe({**about, "accepted": True})
    game.journal.close()
    game.recordings.close()
    if renamed:
        os.replace(folder / "unfinished" / "run-0001.csv", folder / "run-0001.csv")
    again = recordings(folder)
    assert again.read("run-0001").meta.outcome == "success"
    assert again.count == 1 and len(again.board) == 1
    assert check_dataset(folder) == []


class PowerCutError(BaseException):
    """Nothing handles it, as nothing handles the end of a process."""


def test_an_acceptance_cut_off_at_any_of_its_steps_on_the_disk_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = session(tmp_path / "driven")
    drive(game)
    assert game.journal is not None
    game.journal.close()
    game.recordings.close()
    seen = set()
    for step in range(100):
        folder = tmp_path / f"cut-{step}"
        kept = recordings(folder)
        shutil.copytree(tmp_path / "driven" / "unfinished", kept.unfinished, dirs_exist_ok=True)
        table = kept.unfinished / "run-0001.csv"
        ended = SimpleNamespace(table=table, description=table.with_suffix(".json"), close=lambda: None)
        left = [step]

        def cut(whole: Callable[..., Any], *given: Any, left: list[int] = left) -> Any:
            left[0] -= 1
            if left[0] < 0:
                raise PowerCutError
            return whole(*given)

        with monkeypatch.context() as patch:
            for name in ("replace", "fsync", "unlink"):
                patch.setattr(os, name, partial(cut, getattr(os, name)))
            with suppress(PowerCutError):
                kept.accept(ended, game.about())  # type: ignore[arg-type]
        kept.close()
        again = recordings(folder)
        run = again.read("run-0001")
        seen.add(run.meta.outcome)
        assert check_dataset(folder) == []
        assert largest_difference(run, BOAT) == 0.0
        # Once it was noted that the run is accepted, it stays so.
        if "success" in seen:
            assert run.meta.outcome == "success"
        again.close()
        if left[0] > 0:
            break
    assert seen == {"interrupted", "success"} and step > 5


def test_a_description_that_cannot_be_read_still_lets_the_rows_be_found(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    game = session(folder)
    drive(game)
    assert game.journal is not None
    game.journal.close()
    game.recordings.close()
    (folder / "unfinished" / "run-0001.json").write_text("{")
    assert recordings(folder).read("run-0001").meta.outcome == "interrupted"


def test_two_recorders_do_not_write_into_one_dataset(tmp_path: Path) -> None:
    first = recordings(tmp_path / "runs")
    with pytest.raises(UserError, match="another recorder"):
        recordings(tmp_path / "runs")
    first.close()
    recordings(tmp_path / "runs").close()


@pytest.mark.parametrize(
    ("key", "value"), [("vehicle", "swamp-light"), ("source", "human"), ("course", "other")]
)
def test_another_kind_of_run_is_not_added(tmp_path: Path, key: str, value: str) -> None:
    recordings(tmp_path / "runs").close()
    with pytest.raises(UserError, match=f"{key} is"):
        Recordings(tmp_path / "runs", meta(**{key: value}), lambda line: None)


def test_a_disk_that_fills_is_told_and_the_run_can_be_accepted_once_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = session(tmp_path / "runs")
    drive(game)
    assert game.journal is not None
    game.journal.sync()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    save = game.accept()
    with pytest.raises(UserError, match="No space left"):
        save()
    game.not_accepted()
    monkeypatch.undo()
    # Room was made: the same run can still be accepted.
    assert accept(game) == "run-0001"
    assert check_dataset(tmp_path / "runs") == []


def test_names_go_on_from_the_highest_and_nicknames_stay_out_of_them(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.nickname = "../../etc/passwd"
    for _ in range(2):
        drive(game)
        accept(game)
    names = sorted(path.name for path in (tmp_path / "runs").glob("*.csv"))
    assert names == ["run-0001.csv", "run-0002.csv"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["runs"]


def test_the_board_keeps_the_fastest_few_whatever_is_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("swamp_rl.teleop.recordings.BOARD", 2)
    game = session(tmp_path / "runs")
    now = 0.0
    for _ in range(3):
        now = drive(game, now)
        accept(game)
    seconds = sorted(run.duration for run in read_dataset(tmp_path / "runs").runs)
    assert game.recordings.count == 3
    assert [row["seconds"] for row in game.recordings.board] == pytest.approx(seconds[:2])
