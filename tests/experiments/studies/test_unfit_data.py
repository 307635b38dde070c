"""Runs that the report of an experiment could not use are refused before anything is trained."""

import json
from pathlib import Path

import pytest
from swamp_rl.experiments.studies.run import run_experiment, train_experiment
from swamp_rl.experiments.studies.stored import evaluate_folders

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.made_for import made_for
from swamp_rl.pilots.store import save_pilot
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.runs import circling
from tests.support.tiny_experiment import empty_figures, write_tiny


def test_runs_without_a_success_are_refused_in_one_line(tmp_path: Path) -> None:
    data = tmp_path / "runs"
    create_dataset(data, meta_of(load_boat("swamp"), "swamp", 10.0, "measured"))
    append_run(data, Run("one", circling()))
    with pytest.raises(UserError, match="no run is marked successful") as error:
        run_experiment(write_tiny(tmp_path, "scripted"), [f"data={{folder: {data}}}"], tmp_path / "out")
    assert "\n" not in str(error.value) and not (tmp_path / "out").exists()


def test_a_pilot_that_asks_for_more_runs_than_there_are_is_named_with_the_folder(tmp_path: Path) -> None:
    data = tmp_path / "runs"
    create_dataset(data, meta_of(load_boat("swamp"), "swamp", 10.0, "measured"))
    append_run(data, Run("one", circling(), RunMeta(outcome="success")))
    asked = [f"data={{folder: {data}}}", "pilots.net.runs=2"]
    with pytest.raises(UserError) as error:
        train_experiment(write_tiny(tmp_path, "scripted", "net"), asked, tmp_path / "out")
    assert str(error.value) == (
        f"{data}: pilots.net: 2 runs with the outcome success asked for, 1 found; "
        "record more, or ask for fewer"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        (
            "{kind: cloning, options: {reaction: 30.0}}",
            "one: lasts 3 s, less than the reaction of 30 s; lower reaction, or learn from longer runs",
        ),
        (
            "{kind: reservoir, options: {washout: 500}}",
            "washout: 500 leaves no row to learn from, the longest of 1 run has 31; lower washout",
        ),
        (
            "{kind: reservoir-searched}",
            "folds: 5 folds need as many runs, not 1; lower folds, or record more runs",
        ),
    ],
)
def test_settings_that_the_runs_do_not_suffice_for_are_refused_before_any_pilot_is_trained(
    tmp_path: Path, plan: str, message: str
) -> None:
    data = runs_of(tmp_path / "runs", "swamp")
    asked = [f"data={{folder: {data}}}", f"pilots.last={plan}"]
    for task in (run_experiment, train_experiment):
        with pytest.raises(UserError) as error:
            task(write_tiny(tmp_path, "net"), asked, tmp_path / "out")
        assert str(error.value) == f"{data}: pilots.last: {message}"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["runs", "tiny.yaml"]


def runs_of(folder: Path, boat: str | Path) -> Path:
    """A dataset of a run stated to be of the boat."""
    create_dataset(folder, meta_of(load_boat(boat), str(boat), 10.0, "measured"), boat)
    append_run(folder, Run("one", circling(), RunMeta(outcome="success")))
    return folder


def test_runs_of_a_boat_of_another_size_are_refused_before_any_training(tmp_path: Path) -> None:
    launch = tmp_path / "launch.yaml"
    launch.write_text("extends: swamp\nname: launch\nlength: 2.0\n")
    data = runs_of(tmp_path / "runs", launch)
    for task in (run_experiment, train_experiment):
        with pytest.raises(UserError) as error:
            task(write_tiny(tmp_path, "net"), [f"data={{folder: {data}}}"], tmp_path / "out")
        assert str(error.value).startswith(f"{data}: recorded with boat launch (2 m, thrusters azimuth bs,")
        assert "but experiment tiny has boat swamp (1.24 m," in str(error.value)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["launch.yaml", "runs", "tiny.yaml"]


@pytest.mark.parametrize(
    ("boat", "text"),
    [
        ("swamp", ""),
        ("swamp-light", "recorded with boat swamp-light, experiment tiny has swamp"),
        ("mine.yaml", "recorded with another version of boat swamp, experiment tiny has swamp"),
    ],
)
def test_runs_of_another_boat_with_the_same_thrusters_and_size_are_noted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], boat: str, text: str
) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(
        "extends: swamp\nname: swamp\neffects: [{effect: thruster_gain, thruster: all, gain: 0.9}]\n"
    )
    data = runs_of(tmp_path / "runs", mine if boat == "mine.yaml" else boat)
    train_experiment(write_tiny(tmp_path, "scripted"), [f"data={{folder: {data}}}"], tmp_path / "out")
    message = capsys.readouterr().err
    assert text in message and message.count("recorded with") == bool(text)


def test_a_stored_pilot_of_another_boat_is_refused_and_one_of_the_same_thrusters_noted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = made_for(load_boat("swamp-light"), "camogli", 0.1)
    asked = [f"pilots={{mine: {{kind: stored, options: {{folder: {tmp_path / 'pilot'}}}}}}}"]
    save_pilot(LineOfSightPilot(), tmp_path / "pilot", made=made.model_copy(update={"length": 5.0}))
    with pytest.raises(UserError, match=r"was made for boat swamp-light .5 m, .*, it cannot drive swamp"):
        train_experiment(write_tiny(tmp_path, "scripted"), asked, tmp_path / "out")
    save_pilot(LineOfSightPilot(), tmp_path / "pilot", made=made)
    train_experiment(write_tiny(tmp_path, "scripted"), asked, tmp_path / "out")
    assert "pilots.mine: was made for boat swamp-light, it drives swamp" in capsys.readouterr().err


def test_a_pilot_of_another_boat_is_evaluated_under_the_name_of_its_folder_and_the_report_tells_its_boat(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "Lotse für Ü:1"
    save_pilot(LineOfSightPilot(), folder, made=made_for(load_boat("swamp-light"), "camogli", 0.1))
    experiment = write_tiny(tmp_path, "scripted")
    with empty_figures():
        out = evaluate_folders(
            folder, {"episodes": 1, "shown": 1}, ["data.record.good=1"], tmp_path / "out", str(experiment)
        )
    assert (
        f"* **Lotse für Ü_1**: stored in `{folder}`, made for boat swamp-light"
        in (out / "report.md").read_text()
    )
    assert list(json.loads((out / "results.json").read_text())["pilots"]) == ["Lotse für Ü_1"]
    assert (out / "driven" / "Lotse für Ü_1" / "dataset.yaml").is_file()
    assert "pilots.Lotse für Ü_1: was made for boat swamp-light, it drives swamp" in capsys.readouterr().err
