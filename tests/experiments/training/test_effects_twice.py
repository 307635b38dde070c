"""A level of disturbance with an effect that the boat file has already is named before the training."""

from pathlib import Path

import pytest
from swamp_rl.experiments.studies.run import train_experiment

from swamp_rl.files import write_yaml

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
