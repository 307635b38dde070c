"""Datasets of several days become one."""

from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset, read_dataset
from swamp_rl.runs.dataset import files_of
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.kind_of_file import kind_of
from tests.support.runs import circling, described


def day(folder: Path, format: str | None, notes: str | None = None) -> Path:
    """A dataset of one run in this format, or of none."""
    create_dataset(folder, described(notes=notes))
    if format is not None:
        append_run(folder, Run("run-0001", circling()), format)
    return folder


def joined(days: list[Path], out: Path) -> None:
    import_runs(days, kind_of(days), out)


def test_days_of_csv_and_parquet_are_joined_with_the_notes_of_both(tmp_path: Path) -> None:
    days = [day(tmp_path / "monday", "csv", "In rain."), day(tmp_path / "tuesday", "parquet", "In fog.")]
    joined(days, tmp_path / "out")
    found = read_dataset(tmp_path / "out")
    assert [run.name for run in found.runs] == ["monday-run-0001", "tuesday-run-0001"]
    assert found.meta.notes == "In rain. In fog."
    assert [run.meta.group for run in found.runs] == ["monday", "tuesday"]
    joined([tmp_path / "out", day(tmp_path / "wednesday", "csv", "In fog.")], tmp_path / "more")
    more = read_dataset(tmp_path / "more")
    assert len(more.runs) == 3 and more.meta.notes == "In rain. In fog."
    assert [run.meta.group for run in more.runs] == ["monday", "tuesday", "wednesday"]


def test_a_group_of_two_datasets_is_one_of_each_of_them(tmp_path: Path) -> None:
    days = [tmp_path / "monday", tmp_path / "tuesday"]
    for folder in days:
        create_dataset(folder, described())
        append_run(folder, Run("run-0001", circling(), RunMeta(group="morning")))
    append_run(days[1], Run("run-0002", circling(), RunMeta(group="noon")))
    append_run(days[1], Run("run-0003", circling()))
    joined(days, tmp_path / "out")
    groups = [run.meta.group for run in read_dataset(tmp_path / "out").runs]
    assert groups == ["monday morning", "tuesday morning", "noon", "tuesday"]


def test_datasets_of_one_name_are_days_by_the_folders_around_them(tmp_path: Path) -> None:
    days = [day(tmp_path / date / "runs", "csv") for date in ("monday", "tuesday")]
    joined(days, tmp_path / "out")
    found = read_dataset(tmp_path / "out").runs
    assert [run.name for run in found] == ["monday-runs-run-0001", "tuesday-runs-run-0001"]
    assert [run.meta.group for run in found] == ["monday-runs", "tuesday-runs"]


def test_what_keeps_two_datasets_apart_is_named(tmp_path: Path) -> None:
    days = [day(tmp_path / "monday", "csv"), tmp_path / "tuesday"]
    create_dataset(days[1], described(source="human"))
    append_run(days[1], Run("run-0001", circling()), "parquet")
    with pytest.raises(UserError, match=r"tuesday.run-0001.parquet: is of another dataset.*another source"):
        joined(days, tmp_path / "out")


def test_a_day_without_runs_is_named_as_such(tmp_path: Path) -> None:
    days = [day(tmp_path / "monday", "csv"), day(tmp_path / "tuesday", None)]
    with pytest.raises(UserError, match="tuesday: is a dataset without runs; leave it out"):
        import_runs(days, "csv", tmp_path / "out")


def test_a_folder_of_datasets_is_refused_with_how_to_join_them(tmp_path: Path) -> None:
    for name in ("monday", "tuesday"):
        day(tmp_path / name, "csv")
    advice = rf"no runs here; this folder holds datasets; .*{tmp_path}/\* --out NEW"
    with pytest.raises(UserError, match=advice):
        files_of(tmp_path)
