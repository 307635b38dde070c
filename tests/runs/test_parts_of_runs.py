"""Metadata of runs of which rows were left out: only what is true of the rows that are left."""

from pathlib import Path

import pytest

from swamp_rl.runs import Run, RunMeta, append_run, create_dataset, read_dataset
from swamp_rl.runs.earlier_commands import with_earlier_commands
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from tests.support.runs import circling, described

START = {"seed": 1, "initial_state": {"north": 0.0}, "gust_seed": 7}
WHOLE = {"outcome": "success", "gates": [0.5, 2.5], "seconds": 2.0}
LASTING = {"disturbances": [], "group": "monday", "level": "none"}


def entries_of(run: Run) -> set[str]:
    """Which of the entries the run still has."""
    return {key for key, value in run.meta.model_dump().items() if value is not None}


def sailed() -> Run:
    return Run("one", circling(), RunMeta.model_validate(START | WHOLE | LASTING))


@pytest.fixture
def holed(tmp_path: Path) -> Path:
    """A dataset of a run without a position in row 13, and of a whole one."""
    folder = tmp_path / "holed"
    create_dataset(folder, described())
    for name in ("one", "two"):
        append_run(folder, Run(name, sailed().columns, sailed().meta), "csv")
    lines = (folder / "one.csv").read_text().splitlines()
    cells = lines[13].split(",")
    lines[13] = ",".join([cells[0], "", *cells[2:]])
    (folder / "one.csv").write_text("\n".join(lines) + "\n")
    return folder


def test_parts_of_a_run_keep_what_is_true_of_them(holed: Path, tmp_path: Path) -> None:
    import_runs([holed], "csv", tmp_path / "out", None, Wishes(bad_rows="split"))
    first, rest, whole = read_dataset(tmp_path / "out").runs
    assert [len(run.time) for run in (first, rest, whole)] == [12, 18, 31]
    assert entries_of(first) & {*START, *WHOLE} == {*START}
    assert entries_of(rest) & {*START, *WHOLE} == set()
    assert entries_of(whole) >= {*START, *WHOLE}
    assert all(entries_of(run) >= {*LASTING} for run in (first, rest, whole))


def test_the_longest_part_of_a_run_is_reported_as_a_part(holed: Path, tmp_path: Path) -> None:
    import_runs([holed / "one.csv"], "csv", tmp_path / "out", About(outcome="auto"), Wishes(bad_rows="cut"))
    (run,) = read_dataset(tmp_path / "out").runs
    assert run.meta.outcome == "incomplete"
    assert entries_of(run) & {*START, "gates", "seconds"} == set()


def test_a_hole_that_is_filled_leaves_the_run_whole(holed: Path, tmp_path: Path) -> None:
    wishes = Wishes(bad_rows="cut", resample=10.0, fill=0.5)
    import_runs([holed / "one.csv"], "csv", tmp_path / "out", None, wishes)
    (run,) = read_dataset(tmp_path / "out").runs
    assert entries_of(run) >= {*START, *WHOLE}


@pytest.mark.parametrize(("seconds", "kept"), [(0.5, {*START}), (-0.5, set())])
def test_a_run_with_earlier_commands_is_reported_as_the_part_that_is_left(
    seconds: float, kept: set[str]
) -> None:
    found = with_earlier_commands(sailed(), seconds)
    assert entries_of(found) & {*START, *WHOLE} == kept
    assert entries_of(found) >= {*LASTING, "commands_shifted"}
