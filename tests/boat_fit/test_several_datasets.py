"""A boat file fitted to several datasets of one boat: the names of their runs, and what is refused."""

from pathlib import Path

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit import identify
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import written
from tests.support.quick_fit import fit_thrust_alone
from tests.support.sailing import sailed_dataset


def sailed_days(folder: Path) -> Path:
    """The folders may and june of runs of twin.yaml in a folder, and the path of that file."""
    start = written(folder, "twin")
    for seed, day in enumerate(("may", "june")):
        sailed_dataset(folder / day, start, load_boat(start), seed, count=2, seconds=14.0, low=0.0)
    return start


def test_the_runs_of_several_datasets_are_fitted_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = sailed_days(tmp_path)

    fit_thrust_alone(monkeypatch, start)
    found = identify.identify_boat([tmp_path / "may", tmp_path / "june"], None, tmp_path / "new.yaml")
    runs = [*found.data.training.names, *found.data.held_out.names]
    assert {name.split("_")[0] for name in runs} == {"may", "june"}
    assert "identified from may, june" in (tmp_path / "new.yaml").read_text()


def test_the_file_may_end_in_capitals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = sailed_days(tmp_path)
    fit_thrust_alone(monkeypatch, start)
    identify.identify_boat(tmp_path / "may", None, tmp_path / "New.YAML")
    assert load_boat(tmp_path / "New.YAML").name == "New"
    assert (tmp_path / "New.html").is_file()


@pytest.mark.parametrize(
    ("second", "more", "message"),
    [("may", (), "is given twice"), ("june", ("--holdout", "june"), "nothing would be held out")],
)
def test_datasets_that_cannot_be_fitted_together_are_refused_in_one_line(
    tmp_path: Path, call: Call, second: str, more: tuple[str, ...], message: str
) -> None:
    sailed_days(tmp_path)
    assert_complains(call("identify", "boat", "may", second, *more, "--out", "new.yaml"), message)
    assert not list(tmp_path.glob("new*"))
