"""An exported pilot tells the boat and the step that it was made for, as the folder it was exported from."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.artifacts.flown import opened_for
from swamp_rl.experiments.cli.export import export
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.studies.run import train_experiment

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.export import OnnxPilot, write_onnx
from swamp_rl.pilots import save_pilot
from swamp_rl.pilots.arguments import asked_pilot
from swamp_rl.pilots.made_for import made_for
from swamp_rl.pilots.store import describe_pilot
from tests.support.random_pilots import network
from tests.support.tiny_experiment import write_tiny

BOAT, STEP = load_boat("swamp"), 0.1
MADE = made_for(BOAT, "camogli", STEP)
OTHERS = [
    {"boat": "launch", "length": 5.0},
    {"boat": "tug", "thrusters": {"pod": "azimuth"}},
    {"step": 0.2},
]
"""Of pilots that do not suit the boat or the step."""
LIGHT = made_for(load_boat("swamp-light"), "camogli", STEP)


def exported(folder: Path, **changes: object) -> Path:
    """The ONNX file of a pilot, stored in `folder`/pilot, that was made for the boat with these changes."""
    save_pilot(network(np.random.default_rng(0)), folder / "pilot", made=MADE.model_copy(update=changes))
    export(folder / "pilot", folder / "pilot.onnx")
    return folder / "pilot.onnx"


def naming(file: Path) -> list[str]:
    """The overrides of an experiment that names the file of a pilot."""
    return [f"pilots={{mine: {{kind: onnx, options: {{file: {file}}}}}}}", "data.record.good=1"]


def refusal(text: str) -> str:
    with pytest.raises(UserError) as error:
        opened_for(asked_pilot(text), BOAT, STEP)
    return str(error.value)


def test_the_file_tells_what_the_description_of_the_folder_does(tmp_path: Path) -> None:
    found = OnnxPilot(exported(tmp_path)).made
    assert found == MADE == describe_pilot(tmp_path / "pilot").made


@pytest.mark.parametrize("changes", OTHERS)
def test_the_file_is_refused_for_another_boat_or_step_as_the_folder_is(
    tmp_path: Path, changes: dict[str, object]
) -> None:
    file, folder = exported(tmp_path, **changes), tmp_path / "pilot"
    assert refusal(f"onnx:{file}") == refusal(str(folder)).replace(str(folder), str(file))


@pytest.mark.parametrize("changes", OTHERS)
def test_an_experiment_of_another_boat_or_step_refuses_the_file_before_any_work(
    tmp_path: Path, changes: dict[str, object]
) -> None:
    file = exported(tmp_path, **changes)
    with pytest.raises(UserError, match=rf"^{file}: (was made for boat|decides every 0.2 s)"):
        read_scene(load_experiment(write_tiny(tmp_path, "scripted"), naming(file)))


def test_the_file_of_a_similar_boat_drives_with_a_note(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = exported(tmp_path, **dict(LIGHT))
    opened_for(asked_pilot(f"onnx:{file}"), BOAT, STEP)
    assert (
        capsys.readouterr().err.strip() == f"swamp-rl: {file}: was made for boat swamp-light, it drives swamp"
    )


def test_results_tell_the_boat_of_the_file_and_not_that_of_the_experiment(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = exported(tmp_path, **dict(LIGHT))
    out = train_experiment(write_tiny(tmp_path, "scripted"), naming(file), tmp_path / "out")
    assert "pilots.mine: was made for boat swamp-light, it drives swamp" in capsys.readouterr().err
    assert describe_pilot(out / "pilots" / "mine").made == LIGHT


def test_a_file_that_tells_no_boat_drives_any(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_onnx(network(np.random.default_rng(0)), tmp_path / "old.onnx")
    opened_for(asked_pilot(f"onnx:{tmp_path / 'old.onnx'}"), load_boat("esso_osaka"), 0.5)
    assert capsys.readouterr() == ("", "")
