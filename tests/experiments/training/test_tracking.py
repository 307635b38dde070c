"""A training's points reach TensorBoard's event files and, where it is asked for, MLflow."""

import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.training import tracking
from swamp_rl.experiments.training.tracking import track_success, tracked

from swamp_rl.errors import UserError
from tests.support.hostile_names import message_of

POINTS = [(100, {"success": 0.25, "return": -3.0}), (200, {"success": 0.5, "return": 1.5})]


def experiment(mlflow: str | None = None) -> Experiment:
    return load_experiment("smoke", [] if mlflow is None else [f"tracking.mlflow={mlflow}"])


def log_points(folder: Path, asked: Experiment) -> None:
    with tracked(folder, asked, "ppo") as log:
        for step, values in POINTS:
            log(step, values)


def events(folder: Path) -> dict[str, list[tuple[int, float]]]:
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    read = EventAccumulator(str(folder))
    read.Reload()
    return {
        name: [(point.step, point.value) for point in read.Scalars(name)] for name in read.Tags()["scalars"]
    }


def test_event_files_hold_every_point_once_also_after_a_second_life(tmp_path: Path) -> None:
    expected = {name: [(step, values[name]) for step, values in POINTS] for name in ("success", "return")}
    for _ in range(2):
        log_points(tmp_path / "ppo", experiment())
        assert events(tmp_path / "ppo") == expected
        assert len(list((tmp_path / "ppo").iterdir())) == 1


def failing(error: Exception) -> None:
    def fail() -> None:
        raise error

    thread = threading.Thread(target=fail)
    thread.start()
    thread.join()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
@pytest.mark.timed
def test_a_writing_thread_that_the_disk_refuses_prints_no_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed: list[Any] = []
    monkeypatch.setattr(threading, "excepthook", printed.append)
    with tracked(tmp_path / "ppo", experiment(), "ppo") as log:
        log(*POINTS[0])
        failing(OSError("no space left"))
        assert printed == []
        failing(ValueError("a fault of the program"))
        assert [one.exc_type for one in printed] == [ValueError]
    failing(OSError("no space left"))
    assert [one.exc_type for one in printed] == [ValueError, OSError]


def test_a_training_that_logs_nothing_leaves_no_file(tmp_path: Path) -> None:
    with tracked(tmp_path / "reservoir", experiment(), "reservoir"):
        pass
    assert list(tmp_path.iterdir()) == []


def runs(uri: str) -> list[Any]:
    from mlflow import MlflowClient

    client = MlflowClient(tracking_uri=uri)
    found = client.get_experiment_by_name("smoke")
    return [(client, run) for run in client.search_runs([found.experiment_id])]


@pytest.mark.parametrize("store", ["{}/runs", "sqlite:///{}/runs.db"])
def test_mlflow_gets_points_settings_and_how_it_ended(store: str, tmp_path: Path) -> None:
    uri = store.format(tmp_path)
    log_points(tmp_path / "events", experiment(uri))
    with pytest.raises(ValueError, match="halfway"), tracked(tmp_path / "e", experiment(uri), "cloning"):
        raise ValueError("halfway")
    found = {run.info.run_name: (client, run) for client, run in runs(uri)}
    client, run = found["ppo"]
    points = client.get_metric_history(run.info.run_id, "success")
    assert [(point.step, point.value) for point in points] == [(100, 0.25), (200, 0.5)]
    assert run.data.params["decisions"] == "4096" and run.data.params["disturbances"] == "standard"
    assert run.info.status == "FINISHED"
    assert found["cloning"][1].info.status == "FAILED"


def test_mlflow_gets_how_often_each_pilot_succeeded_at_each_level(tmp_path: Path) -> None:
    asked = experiment(f"{tmp_path}/runs")
    won = {"calm": [True, True, False, True], "standard": [False, True, False, False]}
    track_success(
        asked, {(name, level): {"success": np.array(won[level])} for name in asked.pilots for level in won}
    )
    found = {run.info.run_name: run for _, run in runs(f"{tmp_path}/runs")}
    assert set(found) == {f"{name} evaluated" for name in asked.pilots}
    for run in found.values():
        assert run.data.metrics == {"success/calm": 0.75, "success/standard": 0.25}
    assert found["ppo evaluated"].data.params["decisions"] == "4096"


@pytest.mark.parametrize("uri", ["http://127.0.0.1:9", "gopher://nowhere"])
def test_a_store_that_cannot_be_had_is_reported_in_one_line_before_the_training(
    uri: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_MAX_RETRIES", "0")  # MLflow's own, for seconds
    begun = []
    with (
        pytest.raises(UserError, match=f"tracking.mlflow: {uri}") as error,
        tracked(tmp_path / "events", experiment(uri), "ppo"),
    ):
        begun.append(True)
    assert not begun and "\n" not in str(error.value)


def test_without_tensorboard_the_training_goes_on_and_the_extra_is_named_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", None)
    tracking._summary_writer.cache_clear()
    try:
        log_points(tmp_path / "ppo", experiment())
        log_points(tmp_path / "sac", experiment())
    finally:
        tracking._summary_writer.cache_clear()
    assert capsys.readouterr().err.count("pip install 'swamp-rl[tensorboard]'") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_store_among_folders_of_hostile_names_is_used_without_a_word_of_them(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    store = tmp_path / "store"
    for name in ("\x1b[2Jred", "line\nend", "\u202eevil"):
        (store / name).mkdir(parents=True)
    message_of(log_points, tmp_path / "events", experiment(str(store)))  # used, or refused in one line
    printed = "".join(capfd.readouterr())
    assert not any(word in printed for word in ("Traceback", "red", "evil"))
