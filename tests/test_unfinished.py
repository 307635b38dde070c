"""Folders built over more than one life of a process: taken up, begun anew, locked, whole in their place."""

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from swamp_rl import unfinished
from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.replacement import WRITTEN
from swamp_rl.unfinished import folder_beside, locked, taken_up

SAME = {"config/it.yaml": b"a: 1\n"}


def interrupted(path: Path, description: dict[str, bytes] = SAME) -> None:
    """A life that wrote one file and was ended while it wrote another."""
    with pytest.raises(KeyboardInterrupt), taken_up(path, ("mark",), description) as part:
        (part / "done").write_text("done")
        (part / ".part-half").write_text("ha")
        raise KeyboardInterrupt


def names(folder: Path) -> list[str]:
    """Of all files but the lists of them."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != WRITTEN)
    return sorted(path.relative_to(folder).as_posix() for path in files)


def test_a_whole_folder_takes_its_place_and_leaves_nothing_beside_it(tmp_path: Path) -> None:
    with taken_up(tmp_path / "out", (), SAME) as part:
        (part / "mark").write_text("new")
    assert names(tmp_path) == ["out/config/it.yaml", "out/mark"]
    assert (tmp_path / "out" / "config" / "it.yaml").read_bytes() == SAME["config/it.yaml"]


def test_the_same_job_finds_what_was_finished_and_nothing_half_written(tmp_path: Path) -> None:
    interrupted(tmp_path / "out")
    assert not (tmp_path / "out").exists()
    with taken_up(tmp_path / "out", (), SAME) as part:
        assert (part / "done").read_text() == "done"
        assert not (part / ".part-half").exists()
    assert names(tmp_path) == ["out/config/it.yaml", "out/done"]


OTHER = {"config/it.yaml": b"a: 2\n"}


def test_what_another_job_has_finished_is_kept_and_the_difference_reported(tmp_path: Path) -> None:
    interrupted(tmp_path / "out")
    with pytest.raises(UserError) as error, taken_up(tmp_path / "out", (), OTHER):
        pytest.fail("no work may be done")
    for words in (
        ".part-out: holds unfinished work (done)",
        "config/it.yaml: there 'a: 1', now 'a: 2'",
        "repeat the earlier command",
    ):
        assert words in str(error.value)
    assert "\n" not in str(error.value)
    with taken_up(tmp_path / "out", (), SAME) as part:
        assert (part / "done").read_text() == "done"


def test_another_job_continues_what_it_may_continue_under_its_own_description(tmp_path: Path) -> None:
    interrupted(tmp_path / "out")
    asked: list[str] = []

    def continues(part: Path) -> bool:
        asked.append((part / "config" / "it.yaml").read_text())
        return True

    with taken_up(tmp_path / "out", (), OTHER, continues) as part:
        assert (part / "done").read_text() == "done" and not (part / ".part-half").exists()
    assert asked == ["a: 1\n"]
    assert names(tmp_path) == ["out/config/it.yaml", "out/done"]
    assert (tmp_path / "out" / "config" / "it.yaml").read_bytes() == OTHER["config/it.yaml"]


def test_another_job_begins_where_nothing_was_finished(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), taken_up(tmp_path / "out", (), SAME) as part:
        (part / "pilots").mkdir()
        (part / "pilots" / ".new-net").mkdir()
        (part / "pilots" / ".new-net" / "half").write_text("ha")
        raise KeyboardInterrupt
    with taken_up(tmp_path / "out", (), OTHER):
        pass
    assert names(tmp_path) == ["out/config/it.yaml"]
    assert (tmp_path / "out" / "config" / "it.yaml").read_bytes() == OTHER["config/it.yaml"]


def test_an_earlier_result_stays_until_a_whole_one_replaces_it(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mark").write_text("earlier")
    interrupted(out)
    assert (out / "mark").read_text() == "earlier"
    with taken_up(out, ("mark",), SAME) as part:
        (part / "mark").write_text("later")
    assert (out / "mark").read_text() == "later"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_process_that_dies_between_the_two_renames_loses_neither_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mark").write_text("earlier")
    replace = os.replace

    def dies(source: Path, target: Path) -> None:
        if Path(target) == out:
            raise KeyboardInterrupt
        replace(source, target)

    monkeypatch.setattr(unfinished.os, "replace", dies)
    with pytest.raises(KeyboardInterrupt), taken_up(out, ("mark",), SAME) as part:
        (part / "mark").write_text("later")
    monkeypatch.undo()
    assert not out.exists()
    with taken_up(out, ("mark",), SAME) as part:
        assert (out / "mark").read_text() == "earlier"
        assert (part / "mark").read_text() == "later"
    assert (out / "mark").read_text() == "later"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_second_command_on_the_same_folder_is_refused_and_disturbs_nothing(tmp_path: Path) -> None:
    with taken_up(tmp_path / "out", (), SAME) as part:
        (part / "done").write_text("done")
        with pytest.raises(UserError, match="at work on it"), taken_up(tmp_path / "out", (), {"other": b""}):
            pass
        assert (part / "done").exists()
    assert names(tmp_path) == ["out/config/it.yaml", "out/done"]


@pytest.mark.parametrize("there", [False, True], ids=["new", "earlier"])
def test_what_another_program_wrote_meanwhile_is_not_replaced(tmp_path: Path, there: bool) -> None:
    out = tmp_path / "out"
    if there:
        out.mkdir()
        (out / "mark").write_text("earlier")
    for kept, begun in ((1, taken_up(out, ("mark",), SAME)), (0, folder_beside(out, "mark"))):
        with pytest.raises(UserError, match="written by another command meanwhile"), begun as part:
            (part / "mark").write_text("later")
            out.mkdir(exist_ok=True)
            (out / f"run-{kept}").write_text("accepted")
            (out / "mark").touch()
        assert (out / f"run-{kept}").read_text() == "accepted"
        assert [path.name for path in tmp_path.glob(".*")] == [".part-out"]  # of the one to be taken up


def test_an_interrupt_between_the_two_renames_leaves_the_earlier_result_in_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mark").write_text("earlier")
    replace = os.replace

    def interrupts(source: Path, target: Path) -> None:
        if Path(source).name == ".part-out":
            raise KeyboardInterrupt
        replace(source, target)

    monkeypatch.setattr(unfinished.os, "replace", interrupts)
    with pytest.raises(KeyboardInterrupt), taken_up(out, ("mark",), SAME) as part:
        (part / "mark").write_text("later")
    assert (out / "mark").read_text() == "earlier"


def test_a_lock_that_cannot_be_made_is_reported_with_the_path_that_was_asked_for(tmp_path: Path) -> None:
    (tmp_path / ".lock-out").mkdir()
    with pytest.raises(UserError) as error, locked(tmp_path / "out"):
        pytest.fail("no work may be done without the lock")
    assert str(error.value).startswith(f"{tmp_path / 'out'}: ")


def test_a_lock_leaves_no_folder_that_it_made(tmp_path: Path) -> None:
    with locked(tmp_path / "a" / "b" / "out.yaml"):
        assert (tmp_path / "a" / "b").is_dir()
    assert list(tmp_path.iterdir()) == []


def test_a_job_that_cannot_be_begun_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such level"), taken_up(tmp_path / "out", (), SAME) as part:
        (part / ".part-half").write_text("ha")
        raise UserError("no such level")
    assert list(tmp_path.iterdir()) == []


def test_a_job_that_cannot_be_ended_or_has_no_room_left_keeps_what_it_made(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="damaged"), taken_up(tmp_path / "out", (), SAME) as part:
        (part / "first").write_text("done")
        raise UserError("a checkpoint is damaged")
    with pytest.raises(UserError, match="free some room"), taken_up(tmp_path / "out", (), SAME) as part:
        (part / "done").write_text("done")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    with taken_up(tmp_path / "out", (), SAME) as part:
        assert (part / "first").exists() and (part / "done").exists()


def test_what_is_no_earlier_result_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(UserError, match="not an earlier result"), taken_up(tmp_path, ("mark",), SAME):
        pass
    assert names(tmp_path) == ["thesis.txt"]


KILLED = """
import os, signal, sys
from pathlib import Path
from swamp_rl.unfinished import folder_beside
with folder_beside(sys.argv[1]) as part:
    (part / "half").write_text("ha")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("next_one", ["out", "other"])
@pytest.mark.timed
def test_what_a_killed_process_was_building_goes_with_the_next_folder_built_there(
    tmp_path: Path, next_one: str
) -> None:
    ended = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path / "out")], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert any((found / "half").exists() for found in tmp_path.glob(".new-*"))
    with folder_beside(tmp_path / next_one) as part:
        (part / "whole").write_text("whole")
    assert names(tmp_path) == [f"{next_one}/whole"]
    assert [path.name for path in tmp_path.iterdir()] == [next_one]


def test_what_a_living_process_is_building_stays(tmp_path: Path) -> None:
    with folder_beside(tmp_path / "one") as one:
        (one / "whole").write_text("whole")
        with folder_beside(tmp_path / "two"):
            pass
        assert (one / "whole").exists()
    assert names(tmp_path) == ["one/whole"]


@pytest.mark.parametrize("name", ["one.new", "one.lock", "one.part", "one", "lock-one", "new-one"])
def test_work_to_be_taken_up_stays_whatever_its_folder_is_called(name: str, tmp_path: Path) -> None:
    interrupted(tmp_path / name)
    with folder_beside(tmp_path / "one"), folder_beside(tmp_path / "two"):
        pass
    with taken_up(tmp_path / name, ("mark",), SAME) as part:
        with folder_beside(tmp_path / "two"), locked(tmp_path / "three"):
            pass
        assert (part / "done").read_text() == "done"


def test_a_folder_whose_name_begins_as_an_unfinished_one_stays(tmp_path: Path) -> None:
    (tmp_path / ".new-one").mkdir()
    with folder_beside(tmp_path / "two"):
        pass
    assert sorted(path.name for path in tmp_path.iterdir()) == [".new-one", "two"]


def test_what_another_users_process_is_building_hinders_nobody(tmp_path: Path) -> None:
    (tmp_path / ".new-theirs").mkdir()
    (tmp_path / "other").write_text("")
    (tmp_path / ".lock-theirs").symlink_to("other")  # as one without permission, a link cannot be opened
    with folder_beside(tmp_path / "mine") as part:
        (part / "whole").write_text("whole")
    assert names(tmp_path / "mine") == ["whole"]
    assert (tmp_path / ".new-theirs").is_dir()


@pytest.mark.parametrize("place", ["/", "..", "made/.."])
def test_a_place_without_a_name_of_its_own_is_refused_before_any_work(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path / "folder")
    for writer in (folder_beside(place, "mark"), taken_up(place, ("mark",), SAME), write_beside(place)):
        with pytest.raises(UserError, match="give the file or folder to be written a name"), writer:
            pytest.fail("no work may be done for a place that cannot be written")
    assert os.listdir(tmp_path) == ["folder"] and os.listdir() == []


def test_of_two_writers_of_one_folder_the_second_is_refused(tmp_path: Path) -> None:
    with folder_beside(tmp_path / "out") as part:
        for second in (folder_beside(tmp_path / "out"), taken_up(tmp_path / "out", (), SAME)):
            with pytest.raises(UserError, match="out: another command is at work on it"), second:
                pytest.fail("no work may be done for a folder that another writes")
        (part / "whole").write_text("whole")
    assert names(tmp_path) == ["out/whole"]


def test_a_lock_that_is_a_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / ".lock-out").symlink_to(tmp_path / "made")
    with pytest.raises(UserError), folder_beside(tmp_path / "out"):
        pass
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize("leads_to", ["nowhere", "folder", "file"])
def test_a_link_in_the_folders_place_is_refused_before_any_work_and_stays(
    leads_to: str, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("mine")
    out = tmp_path / "out"
    out.symlink_to(tmp_path / leads_to)
    with pytest.raises(UserError, match="is a link"), folder_beside(out):
        raise AssertionError("work is begun")
    with pytest.raises(UserError, match="is a link"), taken_up(out, ("mark",), SAME):
        raise AssertionError("work is begun")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder", "out"]
    assert out.is_symlink() and (tmp_path / "file").read_text() == "mine"


def test_what_another_user_laid_down_as_an_earlier_life_is_not_taken_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupted(tmp_path / "out")
    owner = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    with pytest.raises(UserError, match="belongs to another user"), taken_up(tmp_path / "out", (), SAME):
        raise AssertionError("work is begun")


def test_a_full_disk_names_the_folder_that_was_asked_for(tmp_path: Path) -> None:
    target = tmp_path / "out"
    for folder in (folder_beside(target), taken_up(target, (), {})):
        with pytest.raises(UserError) as caught, folder as part, write_beside(part / "a" / "b.txt"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        assert str(caught.value) == f"{target}: No space left on device; free some room"
