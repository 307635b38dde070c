"""A level of disturbance with an effect that the boat file has already is named before the training."""

from pathlib import Path

import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.studies import closed_loop
from swamp_rl.experiments.studies.run import run_experiment, train_experiment
from swamp_rl.experiments.training.train import notes

from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.runs import read_dataset

HALF = {"effect": "thruster_gain", "thruster": "bs", "gain": 0.5}


def said(folder: Path, capsys: pytest.CaptureFixture[str], *effects: object) -> str:
    write_yaml(folder / "found.yaml", {"effects": list(effects)})
    settings = [f"boat={folder / 'weak.yaml'}", f"evaluation.levels=[calm, {folder / 'found.yaml'}]"]
    train_experiment("smoke", settings, folder / "out", ["line-of-sight"])
    return capsys.readouterr().err


@pytest.fixture
def weak(tmp_path: Path) -> Path:
    write_yaml(tmp_path / "weak.yaml", {"extends": "swamp", "name": "weak", "effects": [HALF]})
    return tmp_path


@pytest.mark.parametrize("thruster", ["bs", "all", {"choice": ["bp", "bs"]}])
def test_the_effect_of_a_diagnosis_on_the_boat_it_extended(
    weak: Path, capsys: pytest.CaptureFixture[str], thruster: object
) -> None:
    line = f"evaluation.levels: {weak / 'found.yaml'}: thruster_gain bs: also in boat weak, and both act; "
    assert line in said(weak, capsys, HALF | {"thruster": thruster})


def test_other_effects_and_thrusters_are_no_matter(weak: Path, capsys: pytest.CaptureFixture[str]) -> None:
    others = HALF | {"thruster": "bp"}, {"effect": "current", "north": 0.1}
    assert "both act" not in said(weak, capsys, *others)


def test_the_level_of_a_record_is_no_matter_where_the_runs_are_given(
    weak: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = write_found(weak)
    settings = [f"boat={weak / 'weak.yaml'}", "evaluation.levels=[calm]"]
    level = f"data.record.disturbances={found}"
    train_experiment("smoke", [*settings, level], weak / "first", ["line-of-sight"])
    assert (
        f"data.record.disturbances: {found}: thruster_gain bs: also in boat weak" in capsys.readouterr().err
    )
    given = [*settings, level, f"data.folder={weak / 'first' / 'data'}"]
    train_experiment("smoke", given, weak / "second", ["line-of-sight"])
    assert "both act" not in capsys.readouterr().err


def test_a_closed_loop_names_its_true_boat_and_not_the_one_that_is_not_evaluated(
    weak: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = write_found(weak)
    loop = {
        "extends": "smoke",
        "name": "loop",
        "pilots": {"scripted": None},
        "hidden": {"effects": [HALF]},
        "evaluation": {"levels": ["calm", f"{found}"]},
    }
    write_yaml(weak / "loop.yaml", loop)

    def stop(*given: object) -> None:
        raise UserError("no logs")

    monkeypatch.setattr(closed_loop, "write_logs", stop)
    with pytest.raises(UserError, match="no logs"):
        run_experiment(weak / "loop.yaml", out=weak / "loop")
    line = f"evaluation.levels: {found}: thruster_gain bs: also in boat swamp-true"
    assert line in capsys.readouterr().err

    scene = read_scene(load_experiment(weak / "loop.yaml"))
    train_experiment("smoke", [], weak / "out", ["line-of-sight"])
    extended = closed_loop.with_boat(scene, f"{weak / 'weak.yaml'}")
    assert not [line for line in notes(extended, read_dataset(weak / "out" / "data")) if "both act" in line]


def write_found(folder: Path) -> Path:
    write_yaml(folder / "found.yaml", {"effects": [HALF]})
    return folder / "found.yaml"
