"""`kill -9` at any instant, the same command again: it goes on from what is finished and ends the same."""

import json
from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.config import learners
from swamp_rl.experiments.config.learners import Learner, Training
from swamp_rl.experiments.evaluation import episodes as trial
from swamp_rl.experiments.studies import main as main_job
from swamp_rl.experiments.studies.run import run_experiment
from swamp_rl.experiments.training import train as learn

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.settings import Settings
from swamp_rl.unfinished import taken_up
from tests.support import forks, killed_experiment
from tests.support.pages import environment
from tests.support.tiny_experiment import content, write_tiny

pytestmark = [pytest.mark.slow, pytest.mark.timed, pytest.mark.usefixtures("no_figures")]


def stopped(*_: Any) -> None:
    raise KeyboardInterrupt


@forks.GROUP
def test_killed_at_any_instant_and_begun_again_it_ends_with_the_same_result(tmp_path: Path) -> None:
    write_tiny(tmp_path)
    words = [killed_experiment.__file__, str(tmp_path), "1"]
    done = forks.run(forks.SCRIPT, words, tmp_path, environment())  # one thread: what is forked may hold none
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.splitlines()[-1]) > 2
    assert content(tmp_path / "broken") == content(tmp_path / "unbroken")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["broken", "tiny.yaml", "unbroken"]


def test_what_is_finished_is_not_done_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_tiny(tmp_path, "scripted", "net")
    with monkeypatch.context() as patched:
        patched.setattr(main_job, "gather", stopped)
        with pytest.raises(KeyboardInterrupt):
            run_experiment(path, out=tmp_path / "out")
    for module, name in ((learn, "record_scripted"), (learn, "_training"), (trial, "drive")):
        monkeypatch.setattr(module, name, stopped)
    out = run_experiment(path, out=tmp_path / "out")
    seconds = json.loads((out / "results.json").read_text())["measured"]["seconds"]
    assert {"record runs", "train net", "evaluate net, calm"} <= seconds.keys()


def test_a_mistyped_override_loses_nothing_that_was_finished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_tiny(tmp_path, "scripted")
    with monkeypatch.context() as patched:
        patched.setattr(main_job, "gather", stopped)
        with pytest.raises(KeyboardInterrupt):
            run_experiment(path, out=tmp_path / "out")
    with pytest.raises(UserError) as error:
        run_experiment(path, ["evaluation.seed=7"], tmp_path / "out")
    assert "holds unfinished work (data, " in str(error.value)
    assert "config/experiment.yaml: there 'seed: 1', now 'seed: 7'" in str(error.value)
    monkeypatch.setattr(learn, "record_scripted", stopped)
    run_experiment(path, out=tmp_path / "out")


def test_a_second_command_on_the_same_folder_is_refused(tmp_path: Path) -> None:
    with (
        taken_up(tmp_path / "out", (), {}),
        pytest.raises(UserError, match="another command is at work on it"),
    ):
        run_experiment(write_tiny(tmp_path, "scripted"), out=tmp_path / "out")


def test_a_learner_goes_on_from_its_checkpoint_and_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[int] = []

    def train(training: Training) -> Pilot:
        assert training.checkpoint is not None
        done = int(training.checkpoint.read_text()) if training.checkpoint.exists() else 0
        begun.append(done)
        for step in range(done, 3):
            if step == 2 and len(begun) == 1:
                raise KeyboardInterrupt
            with write_beside(training.checkpoint) as part:
                part.write_text(str(step + 1))
        return ScriptedPilot(0)

    pupil = Learner(Settings, train, lambda plan: "steps")
    monkeypatch.setitem(learners.LEARNERS, "scripted", lambda: pupil)
    path = write_tiny(tmp_path, "scripted")
    with pytest.raises(KeyboardInterrupt):
        run_experiment(path, out=tmp_path / "out")
    out = run_experiment(path, out=tmp_path / "out")
    assert begun == [0, 2]
    assert [entry.name for entry in (out / "pilots").iterdir()] == ["scripted"]
