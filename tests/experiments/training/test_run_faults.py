"""Runs that are marked successful but teach something else are reported with number, names and remedy."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.studies.run import run_experiment
from swamp_rl.experiments.training.run_faults import run_faults

from swamp_rl.boat import load_boat
from swamp_rl.pilots.record import record_scripted
from swamp_rl.runs import Dataset, Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.from_scratch import written
from tests.support.tiny_experiment import empty_figures, write_tiny


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene(load_experiment("camogli"))


@pytest.fixture(scope="module")
def driven(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    folder = tmp_path_factory.mktemp("driven") / "runs"
    record_scripted(scene.boats_at("standard"), folder, boat="swamp", course="camogli", count=2, step=0.1)
    return read_dataset(folder)


def changed(dataset: Dataset, change: Callable[[Run], dict[str, np.ndarray]]) -> Dataset:
    """The dataset with other columns of its first run."""
    first = dataset.runs[0]
    return replace(dataset, runs=[replace(first, columns=first.columns | change(first)), *dataset.runs[1:]])


def test_sound_runs_have_no_fault(scene: Scene, driven: Dataset) -> None:
    assert run_faults(scene, driven) == []


@pytest.mark.parametrize("boat", ["twin", "crossed"])
def test_runs_of_fixed_thrusters_have_no_fault(tmp_path: Path, boat: str) -> None:
    file = str(written(tmp_path, boat))
    own = read_scene(load_experiment("camogli", [f"boat={file}"]))
    record_scripted(own.boats_at("calm"), tmp_path / "runs", boat=file, course="camogli", count=1, step=0.1)
    assert run_faults(own, read_dataset(tmp_path / "runs")) == []


def test_a_run_that_ends_before_the_last_gate_is_reported_with_the_course(
    scene: Scene, driven: Dataset
) -> None:
    half = changed(
        driven, lambda run: {name: values[: len(values) // 2] for name, values in run.columns.items()}
    )
    (line,) = run_faults(scene, half)
    assert line.startswith(
        f"{driven.folder}: 1 of 2 successful runs (run-001) do not pass every gate of camogli"
    )
    assert line.endswith("set course to theirs")


def test_levers_that_never_move_are_reported(scene: Scene, driven: Dataset) -> None:
    still = changed(driven, lambda run: dict.fromkeys(("joy_thrust", "joy_angle"), np.zeros(len(run.time))))
    (line,) = run_faults(scene, still)
    assert "1 of 2 successful runs (run-001) have levers that never move" in line


@pytest.mark.parametrize(
    "wrong",
    [
        lambda angle: -angle,
        lambda angle: np.roll(angle, 8),
        lambda angle: 0.5 * angle,
    ],
    ids=["of the other sign", "0.8 s late", "of half the range"],
)
def test_levers_that_do_not_give_the_commands_are_reported(
    scene: Scene, driven: Dataset, wrong: Callable[[np.ndarray], np.ndarray]
) -> None:
    (line,) = run_faults(scene, changed(driven, lambda run: {"joy_angle": wrong(run.columns["joy_angle"])}))
    assert (
        "1 of 2 successful runs (run-001) have commands that boat swamp does not make of their levers" in line
    )


def test_levers_without_commands_of_the_thrusters_are_taken_as_they_are(
    scene: Scene, driven: Dataset
) -> None:
    def bare(run: Run) -> Run:
        kept = {name: values for name, values in run.columns.items() if not name.startswith("throttle_")}
        return replace(run, columns=kept | {"joy_angle": -run.columns["joy_angle"]})

    assert run_faults(scene, replace(driven, runs=[bare(run) for run in driven.runs])) == []


@pytest.mark.slow
def test_the_report_tells_the_faults_of_the_runs(
    driven: Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    create_dataset(
        tmp_path / "runs", meta_of(load_boat("swamp"), "swamp", 10.0, "measured", course="camogli")
    )
    for run in driven.runs:
        flipped = run.columns | {"joy_angle": -run.columns["joy_angle"]}
        append_run(tmp_path / "runs", replace(run, columns=flipped))
    asked = [f"data={{folder: {tmp_path / 'runs'}}}", "evaluation.episodes=1"]
    with empty_figures():
        out = run_experiment(write_tiny(tmp_path, "net"), asked, tmp_path / "out")
    fault = "2 of 2 successful runs (run-001, run-002) have commands that boat swamp does not make of their"
    assert capsys.readouterr().err.count(fault) == 1
    page = (out / "report.md").read_text()
    assert f"* Note: {tmp_path / 'runs'}: {fault}" in page
    assert "Training data: 2 successful runs (measured, " in page
