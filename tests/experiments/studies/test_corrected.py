"""A command whose training fails is corrected and given again: the other pilots are not trained anew."""

from pathlib import Path

import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.studies.run import run_experiment, train_experiment
from swamp_rl.experiments.training import train as learn

from swamp_rl.errors import UserError
from tests.support.tiny_experiment import write_tiny

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("no_figures")]

DIVERGES = "pilots.net.options.learning_rate=1e12"


def stopped(*_: object) -> None:
    raise KeyboardInterrupt


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def diverged(experiment: Path, out: Path) -> Path:
    """The unfinished work of an experiment whose pilot `net` diverges after others were trained."""
    with pytest.raises(UserError) as error:
        train_experiment(experiment, [DIVERGES], out)
    assert str(error.value) == "pilots.net: the training diverged; lower learning_rate or weight_decay"
    return out.with_name(f".part-{out.name}")


@pytest.mark.parametrize("correction", ["pilots.net.options.learning_rate=0.01", "pilots.net=null"])
def test_the_corrected_command_keeps_the_runs_and_the_pilots_that_were_trained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, correction: str
) -> None:
    experiment = write_tiny(tmp_path, "reservoir", "net")
    part = diverged(experiment, tmp_path / "out")
    assert names(part / "pilots") == ["reservoir"]
    trained = (part / "pilots" / "reservoir" / "weights.safetensors").stat().st_mtime_ns
    monkeypatch.setattr(learn, "record_scripted", stopped)
    out = run_experiment(experiment, [correction], tmp_path / "out")
    assert (out / "pilots" / "reservoir" / "weights.safetensors").stat().st_mtime_ns == trained
    kept = load_experiment(out).pilots
    assert names(out / "pilots") == sorted(kept)
    assert "net" not in kept or kept["net"].options["learning_rate"] == 0.01


def test_a_training_that_fails_first_leaves_nothing(tmp_path: Path) -> None:
    diverged(write_tiny(tmp_path, "net"), tmp_path / "out")
    assert names(tmp_path) == ["tiny.yaml"]


@pytest.mark.parametrize("change", ["pilots.reservoir.options.ridge=2.0", "data.record.seed=3"])
def test_what_is_trained_is_not_lost_by_another_setting_of_it_or_of_its_runs(
    tmp_path: Path, change: str
) -> None:
    experiment = write_tiny(tmp_path, "reservoir", "net")
    part = diverged(experiment, tmp_path / "out")
    with pytest.raises(UserError, match=r"\.part-out: holds unfinished work .* of another configuration"):
        train_experiment(experiment, [change], tmp_path / "out")
    assert names(part / "pilots") == ["reservoir"]


def test_an_interrupted_training_is_not_lost_by_another_setting_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment = write_tiny(tmp_path, "net")
    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(learn, "save_pilot", stopped)
        train_experiment(experiment, [], tmp_path / "out")
    with pytest.raises(UserError, match="holds unfinished work"):
        train_experiment(experiment, ["pilots.net.options.learning_rate=0.01"], tmp_path / "out")
    assert names(tmp_path / ".part-out" / "pilots") == [".checkpoint-net"]


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        (
            "{kind: cloning, options: {reaction: 59.0}}",
            "data.record: pilots.net: run-001: lasts ",
        ),
        (
            "{kind: reservoir-searched}",
            "override pilots.net={kind: reservoir-searched}: pilots.net.options: folds: 5 folds need",
        ),
        (
            "{kind: cloning, outcomes: [buoy], runs: 9}",
            "data.record: pilots.net: none of 3 runs has the outcome buoy",
        ),
    ],
)
def test_settings_that_the_recorded_runs_do_not_suffice_for_leave_nothing(
    tmp_path: Path, plan: str, message: str
) -> None:
    experiment = write_tiny(tmp_path, "scripted")
    with pytest.raises(UserError) as error:
        train_experiment(experiment, [f"pilots.net={plan}"], tmp_path / "out")
    assert str(error.value).startswith(message) and "\n" not in str(error.value)
    assert names(tmp_path) == ["tiny.yaml"]


def test_pilots_that_were_trained_apart_are_kept_where_another_is_corrected(tmp_path: Path) -> None:
    experiment, out = write_tiny(tmp_path, "scripted", "net"), tmp_path / "out"
    train_experiment(experiment, [DIVERGES], out, only="scripted")
    with pytest.raises(UserError, match=r"pilots\.net: the training diverged"):
        train_experiment(experiment, [DIVERGES], out)
    assert names(out / "pilots") == ["scripted"]
    train_experiment(experiment, [], out)
    assert names(out / "pilots") == ["net", "scripted"] and load_experiment(out) == load_experiment(
        experiment
    )
    with pytest.raises(UserError, match=r"another configuration or version .config.experiment.yaml: there "):
        train_experiment(experiment, [DIVERGES], out)
    (out / "versions.json").unlink()
    with pytest.raises(UserError, match=r"another configuration or version .versions.json: missing there."):
        train_experiment(experiment, [], out)
