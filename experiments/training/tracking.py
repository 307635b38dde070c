"""Trainings as others' tools show them: TensorBoard's event files where the extra `tensorboard` is installed,
MLflow where it is asked for.
"""

import logging
import os
import shutil
import threading
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.results import Tables
from swamp_rl.experiments.artifacts.stages import say
from swamp_rl.experiments.config.schema import Experiment

from swamp_rl.errors import UserError
from swamp_rl.extras import command, missing
from swamp_rl.pilots.callbacks import Log

MLFLOW: dict[str, str] = {
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "MLFLOW_ALLOW_FILE_STORE": "true",  # a plain folder, which MLflow itself keeps up no longer
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "2",
    "MLFLOW_HTTP_REQUEST_TIMEOUT": "10",
}
"""Unless the environment says otherwise: nothing is sent but to the store, and a server that is down is
reported after seconds and not minutes."""


@contextmanager
def tracked(folder: Path, experiment: Experiment, pilot: str) -> Iterator[Log]:
    """Yields what hears the points of one pilot's training.

    folder: of event files; an earlier life's are dropped, since what it logged is logged again. UserError
    where the experiment asks for an MLflow store that cannot be had.
    """
    shutil.rmtree(folder, ignore_errors=True)
    with ExitStack() as stack:
        hear = [_event_files(folder, stack)]
        if experiment.tracking.mlflow is not None:
            hear.append(stack.enter_context(_mlflow_run(experiment, pilot, pilot)))

        def log(step: int, values: Mapping[str, float]) -> None:
            for one in hear:
                one(step, values)

        yield log


def track_success(experiment: Experiment, tables: Tables) -> None:
    """Each pilot's success rates by level, as a run `NAME evaluated` with its settings, where MLflow is asked
    for; UserError where its store cannot be had."""
    if experiment.tracking.mlflow is None:
        return
    for pilot in experiment.pilots:
        rates = {level: table["success"].mean() for (name, level), table in tables.items() if name == pilot}
        with _mlflow_run(experiment, pilot, f"{pilot} evaluated") as log:
            log(0, {f"success/{level}": float(rate) for level, rate in rates.items()})


def _event_files(folder: Path, stack: ExitStack) -> Log:
    """Made at the first point, for many kinds of pilots log none; no file without TensorBoard."""
    writers: list[Any] = []

    def log(step: int, values: Mapping[str, float]) -> None:
        write = _summary_writer()
        if write is None:
            return
        if not writers:
            _without_its_tracebacks(stack)
            writers.append(write(str(folder)))
            stack.callback(writers[0].close)
        for name, value in values.items():
            writers[0].add_scalar(name, value, step)

    return log


def _without_its_tracebacks(stack: ExitStack) -> None:
    """Print no traceback of TensorBoard's thread, whose error is raised again at the next point or close."""
    print_traceback = threading.excepthook
    stack.callback(setattr, threading, "excepthook", print_traceback)

    def hook(failed: threading.ExceptHookArgs) -> None:
        if not isinstance(failed.exc_value, OSError):
            print_traceback(failed)

    threading.excepthook = hook


@cache
def _summary_writer() -> Any:
    """The class that writes event files; None, logged once a process, where TensorBoard is not installed."""
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        say(f"no TensorBoard event files are written: {command('tensorboard')}")
        return None
    return SummaryWriter


@contextmanager
def _mlflow_run(experiment: Experiment, pilot: str, name: str) -> Iterator[Log]:
    """A run of that name, with the pilot's settings, in MLflow's experiment of the experiment's name; failed
    if the block fails."""
    uri = str(experiment.tracking.mlflow)
    with _unlogged():
        client, error_kind = _client(uri)
    plan = experiment.pilots[pilot]
    settings = {"kind": plan.kind, "runs": plan.runs, "disturbances": plan.disturbances, **plan.options}
    try:
        with _unlogged():
            number = _experiment_id(client, experiment.name)
        run = client.create_run(number, run_name=name).info.run_id
        for option, value in settings.items():
            client.log_param(run, option, value)
        ended = "FAILED"
        try:
            yield lambda step, values: _log_metrics(client, run, step, values)
            ended = "FINISHED"
        finally:
            client.set_terminated(run, ended)
    except error_kind as error:
        line = " ".join(str(error).split())[:200]
        raise UserError(f"tracking.mlflow: {uri}: {line}; start the server, or name another store") from error


@contextmanager
def _unlogged() -> Iterator[None]:
    """Without MLflow's own log: of a folder that is no experiment it prints name and traceback."""
    before = logging.root.manager.disable
    logging.disable(logging.WARNING)
    try:
        yield
    finally:
        logging.disable(before)


def _client(uri: str) -> tuple[Any, type[Exception]]:
    for name, value in MLFLOW.items():
        os.environ.setdefault(name, value)
    try:
        from mlflow import MlflowClient
        from mlflow.exceptions import MlflowException
    except ImportError as error:
        raise missing("tracking.mlflow needs MLflow", "mlflow") from error
    try:
        return MlflowClient(tracking_uri=uri), MlflowException
    except MlflowException as error:
        line = " ".join(str(error).split())[:200]
        raise UserError(
            f"tracking.mlflow: {uri}: {line}; name a folder, sqlite:///FILE or a server"
        ) from error


def _experiment_id(client: Any, name: str) -> str:
    found = client.get_experiment_by_name(name)
    return client.create_experiment(name) if found is None else found.experiment_id


def _log_metrics(client: Any, run: str, step: int, values: Mapping[str, float]) -> None:
    for name, value in values.items():
        client.log_metric(run, name, float(value), step=step)
