"""A run is whole on the disk and listed, or not there: whatever stops the writer, and wherever."""

import errno
import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import (
    Run,
    RunMeta,
    append_run,
    check_dataset,
    create_dataset,
    dataset_beside,
    inspect_dataset,
    read_dataset,
)
from swamp_rl.runs.schema import META
from swamp_rl.unfinished import locked
from tests.support.runs import circling, described


class KilledError(BaseException):
    """Stands for the process ending at once: nothing after it runs."""


def kill_at(monkeypatch: pytest.MonkeyPatch, fatal: int) -> None:
    """Let the system call number `fatal` out of those that make a file durable be the last one."""
    calls = 0

    def counted(call):
        def once(*arguments, **options):
            nonlocal calls
            calls += 1
            if calls >= fatal:
                raise KilledError
            return call(*arguments, **options)

        return once

    for name in ("fsync", "replace"):
        monkeypatch.setattr(os, name, counted(getattr(os, name)))
    # A killed process does not tidy up.
    monkeypatch.setattr(Path, "unlink", lambda *_, **__: None)


# Each of two files is flushed, renamed, and its folder flushed.
@pytest.mark.parametrize("fatal", [1, 2, 3, 4, 5, 6])
def test_a_writer_killed_at_any_point_leaves_the_old_runs_readable(
    folder: Path, monkeypatch: pytest.MonkeyPatch, fatal: int
) -> None:
    with monkeypatch.context() as patched:
        kill_at(patched, fatal)
        with pytest.raises(KilledError):
            append_run(folder, Run("three", circling(), RunMeta(outcome="success")))
    found = inspect_dataset(folder)
    names = [run.name for run in found.runs]
    orphan = (folder / "three.parquet").exists() and "three" not in names
    assert names[:2] == ["one", "two"]
    assert [fault.file for fault in found.faults] == (["three.parquet"] if orphan else [])
    assert bool(found.notes) == any(path.name.startswith(".part-") for path in folder.iterdir())
    if orphan:
        assert "not listed" in found.faults[0].message
        (folder / "three.parquet").unlink()
    append_run(folder, Run("four", circling()))
    assert check_dataset(folder) == []


def test_two_writers_of_one_dataset_lose_no_run(folder: Path) -> None:
    names = [f"more-{number}" for number in range(12)]
    with ThreadPoolExecutor(2) as writers:
        list(writers.map(lambda name: append_run(folder, Run(name, circling())), names))
    assert sorted(run.name for run in read_dataset(folder).runs) == sorted([*names, "one", "two"])


def test_a_writer_does_not_wait_for_another_one_for_ever(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("swamp_rl.runs.writer.PATIENCE", 0.05)
    with locked(folder / META), pytest.raises(UserError, match="another command is at work on it"):
        append_run(folder, Run("three", circling()))
    append_run(folder, Run("three", circling()))
    assert check_dataset(folder) == []


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_full_disk_is_one_clear_line_and_leaves_nothing_behind(
    folder: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    before = {path.name: path.read_bytes() for path in folder.iterdir()}

    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UserError, match=rf"three\.{kind}: No space left on device; free some room"):
        append_run(folder, Run("three", circling()), kind)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_run_is_never_overwritten_not_even_in_the_other_format(folder: Path) -> None:
    for kind in ("csv", "parquet"):
        with pytest.raises(UserError, match="already exists"):
            append_run(folder, Run("one", circling()), kind)
    assert len(read_dataset(folder).runs) == 2


def test_a_dataset_is_never_created_over_another(folder: Path) -> None:
    with pytest.raises(UserError, match=r"already holds dataset\.yaml"):
        create_dataset(folder, described())


def test_a_dataset_is_created_where_a_process_was_killed_after_any_of_its_files(tmp_path: Path) -> None:
    create_dataset(tmp_path / "whole", described())
    copies = sorted(path for path in (tmp_path / "whole").iterdir() if path.name != "dataset.yaml")
    for number in range(1, len(copies) + 1):
        folder = tmp_path / str(number)
        folder.mkdir()
        for copy in copies[:number]:
            shutil.copy(copy, folder)
        create_dataset(folder, described())
        append_run(folder, Run("one", circling(), RunMeta()))
        assert check_dataset(folder) == []


@pytest.mark.parametrize("link", [False, True])
def test_another_file_of_a_copys_name_is_left_alone(link: bool, tmp_path: Path) -> None:
    create_dataset(tmp_path / "whole", described())
    copy = next(path for path in (tmp_path / "whole").iterdir() if "course" in path.name)
    folder = tmp_path / "other"
    folder.mkdir()
    if link:
        (folder / copy.name).symlink_to(copy)
    else:
        (folder / copy.name).write_text("mine: 1")
    with pytest.raises(UserError, match="already holds"):
        create_dataset(folder, described())
    assert [path.name for path in folder.iterdir()] == [copy.name]


def test_a_run_that_does_not_fit_the_dataset_is_refused(folder: Path) -> None:
    columns = circling()
    columns["throttle_bs"] = np.full(31, 80.0)
    with pytest.raises(UserError, match=r"column throttle_bs.*percent.*not written"):
        append_run(folder, Run("three", columns))
    assert check_dataset(folder) == []


def test_a_run_needs_a_dataset_to_be_appended_to(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"dataset\.yaml: is missing"):
        append_run(tmp_path, Run("one", circling()))


def test_columns_of_different_lengths_are_the_callers_mistake(folder: Path) -> None:
    with pytest.raises(ValueError, match="one length"):
        append_run(folder, Run("three", circling() | {"depth": np.ones(3)}))


def test_a_new_dataset_takes_the_place_of_its_writers_own_alone(folder: Path, tmp_path: Path) -> None:
    own = described(notes="by this test")
    for _ in range(2):
        with dataset_beside(tmp_path / "own", own) as part:
            append_run(part, Run("first", circling()))
        assert [run.name for run in read_dataset(tmp_path / "own").runs] == ["first"]
    before = sorted(path.name for path in folder.iterdir())
    with pytest.raises(UserError, match="holds other runs"), dataset_beside(folder, own):
        pass
    assert sorted(path.name for path in folder.iterdir()) == before


def test_a_dataset_that_would_be_too_long_to_read_takes_no_more_runs(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    monkeypatch.setattr("swamp_rl.yaml_text.MOST_NODES", 2000)
    meta = RunMeta.model_validate({"remarks": list(range(2000))})
    with pytest.raises(UserError, match=r"as it would be written, .* more than 2000 values"):
        append_run(folder, Run("three", circling(), meta))
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert check_dataset(folder) == []


def test_a_dataset_made_by_the_description_of_another_holds_none_of_its_runs(tmp_path: Path) -> None:
    create_dataset(tmp_path / "all", described())
    append_run(tmp_path / "all", Run("one", circling()))
    there = read_dataset(tmp_path / "all")
    create_dataset(tmp_path / "some", there.meta)
    append_run(tmp_path / "some", there.runs[0])
    assert check_dataset(tmp_path / "some") == []
    assert [run.name for run in read_dataset(tmp_path / "some").runs] == ["one"]
