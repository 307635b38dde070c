"""Nothing that was accepted is ever lost; what was not is there, marked, after any crash."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from swamp_rl.errors import UserError
from swamp_rl.files import find_config
from swamp_rl.runs import DatasetMeta, Run, append_runs, check_dataset, create_dataset, read_dataset
from swamp_rl.runs.dataset import read_meta
from swamp_rl.runs.table import write_table
from swamp_rl.teleop.journal import write_description
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.rows import largest_difference
from swamp_rl.teleop.session import RUN, Session
from tests.support.driving import BOAT, accept, command, drive, meta, recordings, session
from tests.support.patience import PATIENCE
from tests.support.runs import circling, described

pytestmark = pytest.mark.timed

KILLS = 8

# Reads folders and times. Drives there without end, says of each run that was accepted, and after the time is
# killed in the middle of it: a process of its own, forked, so that many such ends take seconds.
RECORDER = """
import os, signal, sys, time
from pathlib import Path
from tests.support.driving import accept, drive, session

def record(folder):
    game, now = session(folder, "standard"), 0.0
    while True:
        now = drive(game, now)
        if game.journal is None:
            game.drop(again=False)
        else:
            print(f"accepted {accept(game)}\\n", end="", flush=True)  # one write, which no kill divides

warm = session(Path(sys.argv[1]), "standard")
drive(warm)
warm.drop(again=False)
warm.close()
for line in sys.stdin:
    after, folder = line.rstrip().split(" ", 1)
    child = os.fork()
    if child == 0:
        try:
            record(Path(folder))
        finally:
            os._exit(1)
    time.sleep(float(after))
    os.kill(child, signal.SIGKILL)
    assert os.WIFSIGNALED(os.waitpid(child, 0)[1])
    print("killed", flush=True)
"""


@pytest.fixture
def killed(tmp_path: Path) -> Iterator[Callable[[Path, float], set[str]]]:
    """Names of the runs that a recorder acknowledged until, after some time [s], it was killed."""
    start = [sys.executable, "-c", RECORDER, str(tmp_path / "warm")]
    process = subprocess.Popen(start, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdin is not None and process.stdout is not None

    def kill(folder: Path, after: float) -> set[str]:
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(f"{after} {folder}\n")
        process.stdin.flush()
        lines = list(iter(process.stdout.readline, "killed\n"))
        return {line.split()[1] for line in lines}

    yield kill
    process.stdin.close()
    process.stdout.close()
    assert process.wait(PATIENCE) == 0


def test_a_kill_at_any_instant_loses_no_accepted_run_and_marks_the_unfinished_one(
    tmp_path: Path, killed: Callable[[Path, float], set[str]]
) -> None:
    folder = tmp_path / "runs"
    acknowledged: set[str] = set()
    # One dataset, so that each start also mends what the kill before left behind.
    for after in np.random.default_rng(5).uniform(0.02, 0.9, KILLS).tolist():
        before = len(names_in(folder))
        acknowledged |= killed(folder, after)
        heard: list[str] = []
        Recordings(folder, meta(), heard.append).close()
        assert names_in(folder) >= acknowledged
        assert len(heard) <= 1 and list((folder / "unfinished").glob("run-*")) == []
        assert check_dataset(folder) == [] or not names_in(folder)
        assert len(names_in(folder)) >= before
    runs = read_dataset(folder).runs
    assert len([run for run in runs if run.meta.outcome == "interrupted"]) <= KILLS
    for run in runs:
        assert largest_difference(run, BOAT) == 0.0


def names_in(folder: Path) -> set[str]:
    return {Path(str(run.file)).stem for run in read_meta(folder).runs} if folder.is_dir() else set()


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder `unfinished` of a recorder that was killed at the end of a run."""
    return ended(tmp_path_factory.mktemp("driven"))[0].recordings.unfinished


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(share=st.floats(0.0, 1.0), described=st.floats(0.0, 1.0) | st.just(1.0))
def test_a_journal_cut_at_any_byte_gives_back_its_whole_rows(
    left: Path, tmp_path_factory: pytest.TempPathFactory, share: float, described: float
) -> None:
    folder = tmp_path_factory.mktemp("cut")
    recordings(folder).close()
    for name, part in (("run-0001.csv", share), ("run-0001.json", described)):
        text = (left / name).read_bytes()
        (folder / "unfinished" / name).write_bytes(text[: round(part * len(text))])
    table = (folder / "unfinished" / "run-0001.csv").read_bytes()
    whole = table[: table.rfind(b"\n") + 1].splitlines()[1:]
    again = recordings(folder)
    again.close()
    assert list((folder / "unfinished").glob("run-*")) == []
    if len(whole) < 2:
        assert names_in(folder) == set()
        return
    run = read_dataset(folder).runs[0]
    assert run.meta.outcome == "interrupted" and again.count == 0
    # Each number is that of the row as it was written, to the bit.
    rows = np.array([[float(cell) for cell in line.split(b",")] for line in whole])
    assert np.column_stack(list(run.columns.values())).tobytes() == rows.tobytes()
    if described == 1.0:
        assert largest_difference(run, BOAT) == 0.0


def ended(folder: Path) -> tuple[Session, dict[str, Any]]:
    """A session whose run has ended, neither accepted nor discarded, and what it is about; no one writes."""
    game = session(folder)
    drive(game)
    assert game.journal is not None
    about = game.about()
    game.journal.close()
    game.recordings.close()
    return game, about


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
    assert found.count == 0 and found.board == [] and found.sentence() == "0 runs, 1 interrupted"
    assert largest_difference(run, BOAT) == 0.0
    assert "never finished" in heard[0]


@pytest.mark.parametrize("renamed", [False, True])
def test_a_run_accepted_but_not_yet_listed_is_listed(tmp_path: Path, renamed: bool) -> None:
    folder = tmp_path / "runs"
    _, about = ended(folder)
    write_description(folder / "unfinished" / "run-0001.json", {**about, "accepted": True})
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
    _, about = ended(tmp_path / "driven")
    seen = set()
    for step in range(100):
        folder = tmp_path / f"cut-{step}"
        kept = recordings(folder)
        shutil.copytree(tmp_path / "driven" / "unfinished", kept.unfinished, dirs_exist_ok=True)
        table = kept.unfinished / "run-0001.csv"
        journal = SimpleNamespace(table=table, description=table.with_suffix(".json"), close=lambda: None)
        steps = [step]

        def cut(whole: Callable[..., Any], *words: Any, steps: list[int] = steps) -> Any:
            steps[0] -= 1
            if steps[0] < 0:
                raise PowerCutError
            return whole(*words)

        with monkeypatch.context() as patch:
            for name in ("replace", "fsync", "unlink"):
                patch.setattr(os, name, partial(cut, getattr(os, name)))
            with suppress(PowerCutError):
                kept.accept(journal, about)  # type: ignore[arg-type]
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
        if steps[0] > 0:
            break
    assert seen == {"interrupted", "success"} and step > 5


def test_a_description_that_cannot_be_read_still_lets_the_rows_be_found(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    ended(folder)
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
def test_another_kind_of_run_is_not_added(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, key: str, value: str
) -> None:
    monkeypatch.chdir(tmp_path)
    if key == "course":
        value = "other.yaml"
        Path(value).write_bytes(find_config("courses", "camogli").read_bytes())
    recordings(tmp_path / "runs").close()
    with pytest.raises(UserError, match=f"{key} is"):
        Recordings(tmp_path / "runs", meta(**{key: value}), lambda line: None)


def test_runs_of_a_boat_whose_file_has_changed_are_not_added(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    boat = Path("mine.yaml")
    boat.write_text("extends: swamp\nname: mine\n")
    Recordings(tmp_path / "runs", meta(vehicle="mine.yaml"), print).close()
    Recordings(tmp_path / "runs", meta(vehicle="mine.yaml"), print).close()
    boat.write_text("extends: swamp\nname: mine\nmass: 57.0\n")
    with pytest.raises(UserError, match="boat mine or of its course has changed"):
        Recordings(tmp_path / "runs", meta(vehicle="mine.yaml"), print)


def test_what_a_killed_recorder_had_half_written_is_cleared_away(tmp_path: Path) -> None:
    recordings(tmp_path / "runs").close()
    half = tmp_path / "runs" / ".part-0a1b2c3d-dataset.yaml"
    half.write_text("vehicle: sw")
    recordings(tmp_path / "runs").close()
    assert not half.exists()


def test_a_disk_that_fills_is_reported_and_the_run_can_be_accepted_once_there_is_room(
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


def test_a_full_dataset_is_reported_and_the_run_stays_to_be_taken_in_once_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = session(tmp_path / "runs")
    drive(game)
    with monkeypatch.context() as full:
        full.setattr("swamp_rl.yaml_text.MOST_NODES", 2000)
        full.setattr(game, "about", lambda: {**Session.about(game), "remarks": list(range(2000))})
        save = game.accept()
        with pytest.raises(UserError, match="could not be read again"):
            save()
    game.not_accepted()
    assert accept(game) == "run-0001"
    assert check_dataset(tmp_path / "runs") == []


def test_opening_a_dataset_reads_its_description_as_often_however_many_runs_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reads: list[int] = []

    def counted(folder: Path) -> DatasetMeta:
        reads[-1] += 1
        return read_meta(folder)

    monkeypatch.setattr("swamp_rl.teleop.recordings.read_meta", counted)
    for count in (1, 6):
        folder = tmp_path / str(count)
        create_dataset(folder, meta())
        append_runs(folder, [Run(f"run-{number:04d}", circling()) for number in range(1, count + 1)], "csv")
        reads.append(0)
        recordings(folder).close()
    assert reads[0] == reads[1] > 0


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
    gates = [run.meta.gates or [] for run in read_dataset(tmp_path / "runs").runs]
    seconds = sorted(last - first for first, last in gates)
    assert game.recordings.count == 3
    assert [row["seconds"] for row in game.recordings.board] == pytest.approx(seconds[:2])


def test_a_table_whose_description_a_power_cut_took_is_taken_in_as_interrupted(tmp_path: Path) -> None:
    Recordings(tmp_path / "runs", described(), lambda line: None).close()
    write_table(tmp_path / "runs" / "unfinished" / "run-0007.csv", circling())
    Recordings(tmp_path / "runs", described(), lambda line: None).close()
    assert list((tmp_path / "runs" / "unfinished").glob("run-*")) == []
    runs = read_dataset(tmp_path / "runs").runs
    assert [(run.name, run.meta.outcome) for run in runs] == [("run-0007", "interrupted")]
