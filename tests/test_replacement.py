"""An earlier result is replaced only if a command wrote everything in it, as it is now."""

import hashlib
import os
import shutil
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.replacement import WRITTEN
from swamp_rl.runs import Run, append_run, read_dataset
from swamp_rl.unfinished import folder_beside, taken_up
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call

Writer = Callable[[Path], AbstractContextManager[Path]]
WRITERS: dict[str, Writer] = {
    "at once": lambda path: folder_beside(path, "mark"),
    "over several lives": lambda path: taken_up(path, ("mark",), {"config/it.yaml": b"a: 1\n"}),
}
STRAIGHT = ("trial", "straight", "--throttle", "0.6", "--duration", "3", "--out", "a")


@pytest.fixture(params=WRITERS.values(), ids=WRITERS.keys())
def writer(request: pytest.FixtureRequest) -> Writer:
    return request.param


def written(writer: Writer, path: Path) -> Path:
    """The folder, with a file and one in a folder."""
    with writer(path) as part:
        (part / "mark").write_text("made")
        (part / "figures").mkdir(exist_ok=True)
        (part / "figures" / "plot.svg").write_text("drawn")
    return path


def add_file(out: Path) -> None:
    (out / "notes.txt").write_text("mine")


def add_deep(out: Path) -> None:
    (out / "figures" / "mine").mkdir()
    (out / "figures" / "mine" / "plot.svg").write_text("drawn")


def add_hidden(out: Path) -> None:
    (out / ".notes").write_text("mine")


def edit(out: Path) -> None:
    (out / "figures" / "plot.svg").write_text("DRAWN")


def rename(out: Path) -> None:
    (out / "figures").rename(out / "kept")


def link(out: Path) -> None:
    (out / "linked").symlink_to(out.parent)


def link_to_nothing(out: Path) -> None:
    (out / "linked").symlink_to("nowhere")


def put_link_in_place(out: Path) -> None:
    shutil.move(out / "figures" / "plot.svg", out.parent / "plot.svg")
    (out / "figures" / "plot.svg").symlink_to(out.parent / "plot.svg")


def put_pipe(out: Path) -> None:
    os.mkfifo(out / "pipe")


def save_result_within(out: Path) -> None:
    written(WRITERS["at once"], out / "another")


def damage_list(out: Path) -> None:
    (out / WRITTEN).write_bytes(b"\xff")


LOST = {
    add_file: "notes.txt",
    add_deep: "figures/mine/plot.svg",
    add_hidden: ".notes",
    edit: "figures/plot.svg",
    rename: "kept/plot.svg",
    link: "linked",
    link_to_nothing: "linked",
    put_link_in_place: "figures/plot.svg",
    put_pipe: "pipe",
    save_result_within: "another/mark",
    damage_list: "mark",
}


@pytest.mark.parametrize("change", LOST, ids=lambda change: change.__name__)
def test_a_result_in_which_something_would_be_lost_is_refused_before_any_work(
    change: Callable[[Path], None], writer: Writer, tmp_path: Path
) -> None:
    out = written(writer, tmp_path / "out")
    change(out)
    before = sorted(out.rglob("*"))
    with pytest.raises(UserError) as error, writer(out):
        pytest.fail("no work may be done where its result cannot take its place")
    assert str(error.value).startswith(f"{out}: is not replaced, as ") and LOST[change] in str(error.value)
    assert "\n" not in str(error.value)
    assert sorted(out.rglob("*")) == before


@pytest.mark.parametrize("change", [add_deep, edit], ids=lambda change: change.__name__)
def test_what_comes_deep_inside_while_the_work_is_done_is_kept(
    change: Callable[[Path], None], writer: Writer, tmp_path: Path
) -> None:
    out = written(writer, tmp_path / "out")
    with pytest.raises(UserError, match="is not replaced"), writer(out) as part:
        (part / "mark").write_text("made again")
        change(out)
    assert (out / "mark").read_text() == "made"
    assert LOST[change] in {path.relative_to(out).as_posix() for path in out.rglob("*")}


def test_a_result_is_read_once_before_the_work_and_once_before_it_is_replaced(
    writer: Writer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = written(writer, tmp_path / "out")
    read: list[str] = []
    digest = hashlib.file_digest
    monkeypatch.setattr(
        "hashlib.file_digest", lambda file, kind: (read.append(str(file.name)), digest(file, kind))[1]
    )
    with writer(out) as part:
        assert read.count(str(out / "mark")) == 1
        (part / "mark").write_text("made again")
    assert read.count(str(out / "mark")) == 2


def test_what_would_be_lost_is_counted_and_the_first_files_named(tmp_path: Path) -> None:
    out = written(WRITERS["at once"], tmp_path / "out")
    for number in range(5):
        (out / f"note-{number}").write_text("mine")
    with pytest.raises(UserError, match="as note-0, note-1, note-2 and 2 more files in it came"):
        written(WRITERS["at once"], out)


def test_what_nobody_wrote_as_their_work_does_not_stand_in_the_way(writer: Writer, tmp_path: Path) -> None:
    out = written(writer, tmp_path / "out")
    for name in (".DS_Store", "figures/Thumbs.db", "__pycache__/it.pyc", ".lock-figures", "._mark"):
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_text("")
    (out / "empty").mkdir()
    (out / "figures" / "plot.svg").unlink()
    assert (written(writer, out) / "figures" / "plot.svg").exists()
    assert not (out / "empty").exists()


def test_a_result_that_was_copied_or_moved_is_still_distinguished_from_what_is_added(tmp_path: Path) -> None:
    out = written(WRITERS["at once"], tmp_path / "out")
    shutil.copytree(out, tmp_path / "copy", copy_function=shutil.copyfile)
    for path in (tmp_path / "copy", out.rename(tmp_path / "moved")):
        written(WRITERS["at once"], path)
        add_file(path)
        with pytest.raises(UserError, match=r"notes\.txt"):
            written(WRITERS["at once"], path)


def test_a_folder_of_an_earlier_version_which_has_no_list_is_replaced(writer: Writer, tmp_path: Path) -> None:
    out = written(writer, tmp_path / "out")
    (out / WRITTEN).unlink()
    add_file(out)
    written(writer, out)
    assert not (out / "notes.txt").exists()


def test_a_trial_is_repeated_with_its_analysis_but_not_over_a_run_that_was_added(call: Call) -> None:
    for _ in range(2):
        assert call(*STRAIGHT)[0] == 0
        assert call("trial", "analyse", "a")[0] == 0
    (run,) = read_dataset("a").runs
    added = append_run("a", Run("driven", run.columns, run.meta))
    assert_complains(
        call(*STRAIGHT), f"dataset.yaml, {added.name} in it came or changed", "name another folder"
    )
    assert len(read_dataset("a").runs) == 2


def test_a_note_beside_the_figures_of_a_trial_is_kept(call: Call) -> None:
    assert call(*STRAIGHT)[0] == 0
    Path("a/analysis/notes.md").write_text("a gust at the end")
    for words in (STRAIGHT, ("trial", "analyse", "a")):
        assert_complains(call(*words), "notes.md in it came or changed")
    assert Path("a/analysis/notes.md").read_text() == "a gust at the end"


def test_a_mission_is_not_simulated_where_its_folder_has_a_note(call: Call) -> None:
    assert call("mission", "survey", "--out", "a")[0] == 0
    Path("a/notes.txt").write_text("mine")
    code, out, error = call("mission", "survey", "--out", "a")
    assert (code, out) == (2, "") and "notes.txt in it came or changed" in error
