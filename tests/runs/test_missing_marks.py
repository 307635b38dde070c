"""Marks of missing values in logs of others: noticed, never taken for a place."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes

TIME = np.round(np.arange(60) * 0.1, 1)
BAD = slice(20, 24)


def log_of(path: Path, mark: float | None) -> Path:
    """A straight track whose position is `mark` in four rows."""
    columns = {"time": TIME, "north": 2.0 * TIME, "east": -3.0 * TIME, "heading": np.full(60, 0.4)}
    for name in ("north", "east") if mark is not None else ():
        columns[name] = columns[name].copy()
        columns[name][BAD] = mark
    rows = [
        ",".join(columns),
        *(",".join(f"{v:.10g}" for v in row) for row in zip(*columns.values(), strict=True)),
    ]
    path.write_text("\n".join(rows) + "\n")
    return path


def imported(path: Path, way: str, wishes: Wishes) -> list[Run]:
    if way == "names":
        import_runs([path], "csv", path.parent / "out", None, wishes)
    else:
        given = [f"{name}={name}" for name in ("time", "north", "east", "heading")]
        import_logs([path], "csv", path.parent / "out", About(), wishes, Reading(mapping_of(given)))
    return read_dataset(path.parent / "out").runs


@pytest.mark.parametrize("way", ["names", "mapping"])
@pytest.mark.parametrize("mark", [-999.0, 9999.0])
def test_a_mark_is_no_place_and_its_rows_can_be_left_out(tmp_path: Path, way: str, mark: float) -> None:
    path = log_of(tmp_path / "log.csv", mark)
    with pytest.raises(UserError) as error:
        imported(path, way, Wishes())
    for name in ("north", "east"):
        assert f"row 21 (line 22), column {name}: is missing, marked by {mark:.0f}" in str(error.value)
    assert "(--bad-rows cut or split)" in str(error.value)
    first, second = imported(path, way, Wishes(bad_rows="split"))
    assert np.concatenate([first.time, second.time]) == pytest.approx(np.delete(TIME, BAD))


def test_a_track_that_passes_through_such_a_number_is_whole(tmp_path: Path) -> None:
    path = log_of(tmp_path / "log.csv", None)
    shifted = path.read_text().splitlines()
    rows = [line.split(",") for line in shifted[1:]]
    places = [f"{float(row[1]) - 1003.0:.10g}" for row in rows]
    assert "-999" in places
    text = "\n".join(
        [shifted[0], *(",".join([row[0], place, *row[2:]]) for row, place in zip(rows, places, strict=True))]
    )
    path.write_text(text + "\n")
    (run,) = imported(path, "names", Wishes())
    assert len(run.time) == 60


def with_shaft(path: Path, rpm: np.ndarray, wishes: Wishes) -> Run:
    """The run of a log with a column of revolutions."""
    table = {"t": TIME, "n": TIME, "e": TIME, "psi": 0.1 * TIME, "rpm": rpm}
    rows = [",".join(map(str, row)) for row in zip(*table.values(), strict=True)]
    path.write_text("\n".join([",".join(table), *rows]) + "\n")
    given = ["time=t", "north=n", "east=e", "heading=psi", "speed_of_shaft=rpm"]
    import_logs([path], "csv", path.parent / "out", About(), wishes, Reading(mapping_of(given)))
    (run,) = read_dataset(path.parent / "out").runs
    return run


@pytest.mark.parametrize("levels", [(0.0, 999.0, 0.0), (0.0, 999.0, 50.0, 999.0, 0.0)])
def test_a_step_of_a_command_to_999_is_no_mark(tmp_path: Path, levels: tuple[float, ...]) -> None:
    rpm = np.repeat(levels, 60 // len(levels))
    assert with_shaft(tmp_path / "log.csv", rpm, Wishes()).columns["speed_of_shaft"].tolist() == rpm.tolist()


def test_a_brief_mark_in_a_column_that_rarely_changes_is_one(tmp_path: Path) -> None:
    rpm = np.where(np.arange(60) == 20, 9999.0, 30.0)
    run = with_shaft(tmp_path / "log.csv", rpm, Wishes(bad_rows="cut"))
    assert run.columns["speed_of_shaft"].tolist() == [30.0] * 39


def compass(degrees: bool) -> np.ndarray:
    """A heading of 0 to 360 degrees that crosses north five times, with a mark in one row."""
    angle = np.round(
        np.mod(30.0 * np.arange(60.0), 360.0) if degrees else np.mod(0.5 * np.arange(60.0), 6.28), 4
    )
    angle[30] = -999.0
    return angle


@pytest.mark.parametrize(
    ("given", "degrees"),
    [
        ("yaw=psi", True),
        ("heading=psi", True),
        ("heading=psi", False),
        ("heading=radians(psi)", True),
        ("--column", True),
        ("--column", False),
    ],
)
def test_a_mark_in_a_compass_that_crosses_north_is_one(tmp_path: Path, given: str, degrees: bool) -> None:
    path = tmp_path / "log.csv"
    columns = {"time": TIME, "north": TIME, "east": TIME, "psi": compass(degrees)}
    rows = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    ours = "yaw" if given == "yaw=psi" else "heading"
    wishes = Wishes(units={ours: "deg"} if degrees and "radians" not in given else {})

    def made(wishes: Wishes) -> list[Run]:
        if given == "--column":
            import_runs([path], "csv", tmp_path / "out", None, replace(wishes, renamed={"heading": "psi"}))
        else:
            reading = Reading(mapping_of(["time=time", "north=north", "east=east", given]))
            import_logs([path], "csv", tmp_path / "out", About(), wishes, reading)
        return read_dataset(tmp_path / "out").runs

    with pytest.raises(UserError) as error:
        made(wishes)
    (line,) = str(error.value).splitlines()
    assert "row 31 (line 32), column heading: is missing, marked by -999" in line
    runs = made(replace(wishes, bad_rows="split"))
    assert [len(run.time) for run in runs] == [30, 29]


def test_one_wrong_heading_leaves_the_others_wrapped(tmp_path: Path) -> None:
    angle = np.where(np.arange(60) == 30, 500.0, 200.0 + np.arange(60.0))
    columns = {"time": TIME, "north": TIME, "east": TIME, "heading": angle}
    path = tmp_path / "log.csv"
    rows = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    runs = imported(path, "names", Wishes(units={"heading": "deg"}, bad_rows="split"))
    assert [len(run.time) for run in runs] == [30, 29]
