"""Several datasets diagnosed together: the names and groups of their runs, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from swamp_rl.api import simulate
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.inputs import Inputs
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.runs import circling, described


def recorded(folder: Path, *groups: str | None, **meta: object) -> Path:
    create_dataset(folder, described(**meta))
    for number, group in enumerate(groups):
        append_run(folder, Run(f"run_{number}", circling(30.0), RunMeta(group=group)), "csv")
    return folder


def test_each_dataset_is_a_day_and_its_runs_have_its_name_before_theirs(tmp_path: Path) -> None:
    folders = [recorded(tmp_path / "may", None, None), recorded(tmp_path / "june", None)]
    run_set = read_run_set(folders, load_boat("swamp"))
    assert run_set.names == ("may_run_0", "may_run_1", "june_run_0")
    assert run_set.groups["day"] == (1, 1, 0)
    assert run_set.group_names("day") == ["june", "may"]


def test_the_groups_that_a_dataset_names_stay_apart_from_those_of_another(tmp_path: Path) -> None:
    folders = [recorded(tmp_path / "may", "am", "pm"), recorded(tmp_path / "june", "am", "am")]
    run_set = read_run_set(folders, load_boat("swamp"))
    assert run_set.days == ("may am", "may pm", "june am", "june am")


def test_datasets_of_one_name_are_told_apart_by_the_folders_around_them(tmp_path: Path) -> None:
    folders = [recorded(tmp_path / day / "runs", None) for day in ("may", "june")]
    run_set = read_run_set(folders, load_boat("swamp"))
    assert run_set.names == ("may_runs_run_0", "june_runs_run_0")
    assert run_set.days == ("may_runs", "june_runs")


def test_names_that_agree_with_the_folders_around_them_are_refused(tmp_path: Path) -> None:
    folders = [recorded(tmp_path / path, None) for path in ("may/runs", "june/runs", "may_runs")]
    with pytest.raises(UserError, match=r"may_runs: would be called may_runs like .*; rename one"):
        read_run_set(folders, load_boat("swamp"))


def test_one_dataset_keeps_its_names(tmp_path: Path) -> None:
    folder = recorded(tmp_path / "may", None)
    assert read_run_set([folder], load_boat("swamp")).names == ("run_0",)


def test_without_a_boat_file_the_dataset_is_compared_with_its_own_boat(tmp_path: Path) -> None:
    light = load_boat("swamp-light")
    folder = tmp_path / "may"
    create_dataset(folder, described(vehicle="swamp-light"))
    steered = np.repeat([[0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5]], 400, axis=0)
    steered[100:250, :4] = np.radians([25.0, 25.0, -25.0, -25.0])
    append_run(folder, simulate(light, steered), "csv")
    found = diagnose(folder, None, tmp_path / "answer", twins=0)
    assert found.verdict == "nothing_wrong"
    assert load_boat(tmp_path / "answer" / "extended_boat.yaml").mass == light.mass


def test_a_payload_that_differs_between_days_is_named_with_the_mass_of_each(tmp_path: Path) -> None:
    steered = np.repeat([[0.0, 0.0, 0.0, 0.0, 0.7, 0.7, 0.7, 0.7]], 300, axis=0)
    steered[60:120, :4] = np.radians([25.0, 25.0, -25.0, -25.0])
    steered[120:200, 4:] = [0.2, 0.6, 0.2, 0.6]
    masses = {"monday": 49.0, "tuesday": 56.0}
    for day, mass in masses.items():
        load = {"effect": "mass", "mass": mass}
        write_yaml(tmp_path / f"{day}.yaml", {"extends": "swamp", "name": day, "effects": [load]})
        create_dataset(tmp_path / day, described())
        for name, commands in (("port", steered), ("starboard", steered[:, [1, 0, 3, 2, 5, 4, 7, 6]])):
            run = simulate(tmp_path / f"{day}.yaml", commands)
            append_run(tmp_path / day, replace(run, name=name), "csv")
    found = diagnose([tmp_path / day for day in masses], "swamp", tmp_path / "answer", twins=0)
    (payload,) = found.causes
    assert payload.label == "mass by_day"
    for day, mass in masses.items():
        assert payload.groups[day]["mass"].value == pytest.approx(mass, abs=0.1)
        (path,) = (tmp_path / "answer" / "conditions").glob(f"{day}*port.yaml")
        (written,) = yaml.safe_load(path.read_text())["effects"]
        assert written["mass"] == pytest.approx(mass, abs=0.1)
    assert load_boat(tmp_path / "answer" / "extended_boat.yaml").mass == load_boat("swamp").mass


def test_the_effects_of_the_boat_of_simulated_runs_are_named(tmp_path: Path, call: Call) -> None:
    half = {"effect": "thruster_gain", "thruster": "bs", "gain": 0.5}
    write_yaml(tmp_path / "weak.yaml", {"extends": "swamp", "name": "weak", "effects": [half]})
    assert call("record-scripted", "--boat", "weak.yaml", "--count", 1, "--out", "runs")[0] == 0
    (tmp_path / "answer").mkdir()
    (tmp_path / "answer" / "mine").write_text("")
    line = "the boat file has thruster_gain bs: only what differs from these is named"
    assert line in call("diagnose", "runs", "--out", "answer")[1]  # refused before the search
    assert line not in call("diagnose", "runs", "--boat", "swamp", "--out", "answer")[1]


@pytest.mark.parametrize(
    ("second", "message"),
    [
        ("may", "is given twice"),
        ("june", "recorded with boat swamp-light"),
    ],
)
def test_what_cannot_be_diagnosed_together_is_refused_in_one_line(
    tmp_path: Path, second: str, message: str
) -> None:
    first = recorded(tmp_path / "may", None)
    if second != "may":
        recorded(tmp_path / second, None, vehicle="swamp-light")
    with pytest.raises(UserError, match=message) as refused:
        diagnose([first, tmp_path / second], "swamp", tmp_path / "answer")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "answer").exists()


def test_of_many_datasets_a_message_names_the_first() -> None:
    folders = tuple(Path(f"day{number}") for number in range(9))
    assert Inputs(folders[:2], "swamp", None).label == "day0, day1"
    assert Inputs(folders, "swamp", None).label == "day0 and 8 others"
