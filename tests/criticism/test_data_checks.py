"""Data that no diagnosis is possible from are refused in one line before any fit, and nothing is written."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.criticism import diagnose as module
from swamp_rl.criticism.data.excitation import missing_motion
from swamp_rl.criticism.data.run_set import read_run_set, run_set_of
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, append_run, create_dataset
from swamp_rl.unfinished import folder_beside
from tests.support.runs import circling, described

pytestmark = pytest.mark.numerical

Columns = dict[str, NDArray[np.float64]]
Change = Callable[[Columns], Columns]
BOATS = Path(__file__).parents[2] / "configs" / "boats"


class FittedError(Exception):
    """Raised in place of all fitting."""


@pytest.fixture(autouse=True)
def nothing_is_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A diagnosis that passes every refusal ends here."""

    def examine(*_: object) -> None:
        raise FittedError

    monkeypatch.setattr(module, "examine", examine)


def recorded(folder: Path, *changes: Change, **meta: object) -> Path:
    """A dataset of a circle of 30 s for each change; the files are written as they are, right or wrong."""
    create_dataset(folder, described(**meta))
    for number, change in enumerate(changes):
        name = f"run_{number}"
        append_run(folder, Run(name, circling(30.0)), "csv")
        columns = change(circling(30.0))
        rows = [",".join(columns)]
        rows += [
            ",".join("" if np.isnan(v) else repr(float(v)) for v in row)
            for row in zip(*columns.values(), strict=True)
        ]
        (folder / f"{name}.csv").write_text("\n".join(rows) + "\n")
        meta_file = folder / "dataset.yaml"
        listed = yaml.safe_load(meta_file.read_text())
        listed["runs"][number].pop("rows", None)
        meta_file.write_text(yaml.safe_dump(listed))
    return folder


def as_it_is(columns: Columns) -> Columns:
    """A sound run."""
    return columns


def setting(**values: float) -> Change:
    """A run with the same number in every row of some columns."""
    return lambda columns: columns | {k: np.full_like(columns["time"], v) for k, v in values.items()}


def without(*names: str) -> Change:
    """A run without some columns."""
    return lambda columns: {k: v for k, v in columns.items() if k not in names}


def cut(rows: slice) -> Change:
    """Some rows of a run."""
    return lambda columns: {k: v[rows] for k, v in columns.items()}


def back_in_time(columns: Columns) -> Columns:
    """The clock set back by 5 s at the 101st row."""
    return columns | {"time": columns["time"] - 5.0 * (np.arange(len(columns["time"])) >= 100)}


def jumping_ahead(columns: Columns) -> Columns:
    """The clock set ahead by as many steps of 0.1 s as no memory holds at the 101st row."""
    return columns | {"time": columns["time"] + 1e9 * (np.arange(len(columns["time"])) >= 100)}


def at_rest(columns: Columns) -> Columns:
    """A boat at its berth under a receiver of 0.5 m, its thrusters as commanded."""
    rng = np.random.default_rng(0)
    sizes = {"north": 0.5, "east": 0.5, "heading": 0.02, "surge": 0.05, "sway": 0.05, "yaw_rate": 0.01}
    return columns | {k: s * rng.standard_normal(len(columns["time"])) for k, s in sizes.items()}


STOPPED = setting(throttle_bs=0.0, throttle_bp=0.0, throttle_ss=0.0, throttle_sp=0.0)
REFUSED: dict[str, tuple[Change, str]] = {
    "three seconds": (cut(slice(31)), "too short: 0 s in runs of at least 10 s (the longest lasts 3 s)"),
    "no rows": (cut(slice(0)), "run_0.csv: holds no rows"),
    "a sample every two seconds": (cut(slice(None, None, 20)), "a sample every 2 s"),
    "commands all zero": (STOPPED, "no thruster ever runs"),
    "a boat at rest": (at_rest, "record runs ahead at two speeds and turns to both sides"),
    "a channel of no numbers": (setting(yaw_rate=np.nan), "column yaw_rate: holds no number in any row"),
    "no position": (without("north", "east"), "column north: is missing; add it"),
    "a dead receiver": (setting(north=0.0, east=0.0), "north and east are the same in every row"),
    "a dead compass": (setting(heading=1.0), "heading is the same in every row"),
    "a yaw rate of zeros": (setting(yaw_rate=0.0), "yaw_rate is 0 in every row though the boat moves"),
    "time going back": (back_in_time, "run run_0, row 101: time 5 s does not come after 9.9 s"),
    "time jumping ahead": (jumping_ahead, "run run_0, row 101: comes 1e+09 s after the row before"),
    "no time": (without("time"), "column time is missing; add it"),
    "no commands": (without("throttle_sp"), "column throttle_sp: is missing; add it"),
}


def complaint(dataset: Path, boat: str | Path, out: Path, holdout: Path | None = None) -> str:
    """What a diagnosis is refused with."""
    before = sorted(out.parent.rglob("*"))
    with pytest.raises(UserError) as error:
        diagnose(dataset, boat, out, holdout)
    assert "\n" not in str(error.value)
    assert sorted(out.parent.rglob("*")) == before
    return str(error.value)


def test_sound_runs_are_not_refused(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is)
    with pytest.raises(FittedError):
        diagnose(data, "swamp", tmp_path / "out", recorded(tmp_path / "other", cut(slice(1, None))))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("case", REFUSED)
def test_runs_that_tell_nothing_are_refused_in_one_line_that_names_them(case: str, tmp_path: Path) -> None:
    change, result = REFUSED[case]
    data = recorded(tmp_path / "data", change)
    message = complaint(data, "swamp", tmp_path / "out")
    assert message.startswith(str(data)) and result in message


def test_a_folder_without_runs_and_one_that_is_none_are_refused(tmp_path: Path) -> None:
    assert "lists no runs" in complaint(recorded(tmp_path / "data"), "swamp", tmp_path / "out")
    (tmp_path / "bare").mkdir()
    assert "dataset.yaml: is missing" in complaint(tmp_path / "bare", "swamp", tmp_path / "out")
    assert "no such folder" in complaint(tmp_path / "nowhere", "swamp", tmp_path / "out")


def test_a_boat_file_that_lacks_a_thruster_that_ran_is_refused(tmp_path: Path) -> None:
    boat = yaml.safe_load((BOATS / "swamp.yaml").read_text())
    boat |= {"name": "two", "thrusters": boat["thrusters"][:2]}
    (tmp_path / "two.yaml").write_text(yaml.safe_dump(boat))
    data = recorded(tmp_path / "data", as_it_is)
    message = complaint(data, tmp_path / "two.yaml", tmp_path / "out")
    assert "column throttle_ss drives a thruster that boat two does not have (it has bs, bp)" in message
    assert "names the vehicle swamp: give that by --boat or leave it out, or add the thruster" in message
    message = complaint(data, "esso_osaka", tmp_path / "out")
    assert "names the vehicle swamp: give that by --boat or leave it out, or record the column" in message
    renamed = recorded(tmp_path / "renamed", setting(**{"left %": 0.5}))
    advice = "if one of 'left %' is it, import with --column rudder_main=THEIRS"
    assert advice in complaint(renamed, "esso_osaka", tmp_path / "out")
    idle = recorded(tmp_path / "idle", setting(throttle_ss=0.0, throttle_sp=0.0))
    with pytest.raises(FittedError):
        diagnose(idle, tmp_path / "two.yaml", tmp_path / "out")


def test_a_boat_file_that_is_none_is_refused(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is)
    (tmp_path / "boat.yaml").write_text("only text\n")
    assert "must be a mapping" in complaint(data, tmp_path / "boat.yaml", tmp_path / "out")
    assert "no such file" in complaint(data, tmp_path / "none.yaml", tmp_path / "out")


def test_runs_held_out_must_be_others_of_the_same_boat_and_as_sound(tmp_path: Path) -> None:
    data, out = recorded(tmp_path / "data", as_it_is), tmp_path / "out"
    light = recorded(tmp_path / "light", as_it_is, vehicle="swamp-light")
    message = complaint(data, "swamp", out, light)
    assert f"{light}: recorded with boat swamp-light, but {data} with swamp" in message
    assert "nothing would be held out" in complaint(data, "swamp", out, data)
    dead = recorded(tmp_path / "dead", setting(heading=1.0))
    assert complaint(data, "swamp", out, dead).startswith(str(dead))


def test_a_run_is_not_held_out_that_is_fitted_to_nor_fitted_to_twice(tmp_path: Path) -> None:
    data, other = recorded(tmp_path / "data", as_it_is), recorded(tmp_path / "other", as_it_is)
    assert "it would be held out and fitted to" in complaint(data, "swamp", tmp_path / "out", other)
    with pytest.raises(UserError, match="other_run_0 are the same run; leave one of the two"):
        diagnose([data, other], "swamp", tmp_path / "out")


def test_nothing_is_written_over_what_is_no_diagnosis_or_what_it_is_made_from(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is)
    assert f"{data}: holds {data}" in complaint(data, "swamp", data)
    full = tmp_path / "full"
    full.mkdir()
    (full / "mine.txt").write_text("mine")
    assert "already exists and is not an earlier result" in complaint(data, "swamp", full)
    (full / "diagnosis.json").write_text("{}")
    (full / "extended_boat.yaml").write_text("extends: swamp\n")
    assert "name another --out" in complaint(data, full / "extended_boat.yaml", full)


def test_runs_left_out_and_runs_at_rest_are_reported(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is, cut(slice(31)), at_rest)
    lacks = missing_motion(read_run_set(data, load_boat("swamp")))
    assert "length in run_1: shorter than 10 s, left out" in lacks
    assert any(one.startswith("way in run_2: the boat stands still there") for one in lacks)


def test_a_folder_that_another_diagnosis_is_writing_is_refused(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is)
    with (
        folder_beside(tmp_path / "out"),
        pytest.raises(UserError, match="out: another command is at work on it"),
    ):
        diagnose(data, "swamp", tmp_path / "out")


def test_a_plain_folder_of_tables_is_diagnosed_as_runs_of_the_boat_that_is_named(tmp_path: Path) -> None:
    data = recorded(tmp_path / "data", as_it_is)
    for path in data.iterdir():
        if path.suffix != ".csv":
            path.unlink()
    with pytest.raises(FittedError):
        diagnose(data, "swamp", tmp_path / "out")


def test_a_throttle_from_full_astern_to_full_ahead_is_interpolated_over_a_lost_row() -> None:
    columns = circling(30.0)
    rows = np.arange(len(columns["time"]))
    columns["throttle_bs"] = np.where(rows < 100, -1.0, 1.0)
    kept = rows != 100
    run = Run("run", {name: values[kept] for name, values in columns.items()})
    found = run_set_of([run], load_boat("swamp"), "folder")
    place = len(found.boat.thrusters) + found.boat.thruster_names.index("bs")
    assert list(found.commands[0, 99:102, place]) == [-1.0, 0.0, 1.0]


def test_the_second_of_two_rows_in_one_sample_step_is_named() -> None:
    columns = circling(30.0)
    columns["time"][101:] -= 0.09
    columns["time"][40] += 0.02  # further off the grid, but alone
    with pytest.raises(UserError, match="row 102: time"):
        run_set_of([Run("run", columns)], load_boat("swamp"), "folder")
