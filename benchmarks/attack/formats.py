"""Every format that the package reads: how a good file of it is made, and the reader that meets a bad one."""

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.attack.design_formats import DESIGN_FORMATS, read_level
from benchmarks.attack.folder_formats import FOLDER_FORMATS
from benchmarks.attack.link_formats import LINK_FORMATS
from benchmarks.attack.log_formats import LOG_FORMATS
from benchmarks.attack.samples import (
    circle,
    copied_config,
    dataset_with,
    make_arrays,
    make_checkpoint,
    make_diagnosis,
    make_episodes,
    make_free_running,
    make_mcap,
    make_message,
    make_onnx,
    make_pilot,
    make_row,
    make_telemetry,
    make_text,
    make_trials,
    make_unfinished,
    meta,
)
from swamp_rl.errors import UserError
from swamp_rl.runs import create_dataset

SAFETENSORS = "weights.safetensors"


@dataclass(frozen=True)
class Format:
    """One format: `make` puts a good file into a folder and returns its path; `read` reads the file there.
    `disguise` makes bytes look whole where a checksum would stop them before the parser."""

    make: Callable[[Path], Path]
    read: Callable[[Path], Any]
    disguise: Callable[[bytes], bytes] = bytes


def outcome(format: Format, path: Path, data: bytes) -> str:
    """`accepted` or `refused` when the reader meets `data` at `path`; any other exception is let through.

    AssertionError where a line of the refusal does not name the file, or it is too long to be read.
    """
    path.write_bytes(format.disguise(data))
    try:
        format.read(path)
    except UserError as error:
        message = str(error)
        assert len(message) < 30_000, f"too long: {message[:200]!r}"
        for line in message.split("\n"):
            assert line.isprintable() and len(line) < 3000, f"no short line: {line[:200]!r}"
        return "refused"
    return "accepted"


def _experiment(path: Path) -> Any:
    from swamp_rl.experiments.config.load import load_experiment

    return load_experiment(path)


def _override(path: Path) -> Any:
    from swamp_rl.experiments.config.load import load_experiment

    return load_experiment("smoke", [path.read_bytes().decode("utf-8", "surrogateescape")])


def _sweep(path: Path) -> Any:
    from swamp_rl.experiments.sweep.schema import load_sweep

    return load_sweep(path)


def _boat(path: Path) -> Any:
    from swamp_rl.boat import load_boat

    return load_boat(path)


def _course(path: Path) -> Any:
    from swamp_rl.course import load_course

    return load_course(path)


def _plan(path: Path) -> Any:
    from swamp_rl.manoeuvres.plan import load_plan

    return load_plan(path).singly


def _inspected(path: Path) -> Any:
    from swamp_rl.runs import read_dataset

    return read_dataset(path.parent)


def _imported(kind: Any, **about: Any) -> Callable[[Path], Any]:
    def read(path: Path) -> Any:
        import shutil

        from swamp_rl.runs.import_dataset import About, import_runs
        from swamp_rl.runs.import_foreign import Wishes

        out = path.parent / "imported"
        shutil.rmtree(out, ignore_errors=True)
        wishes = Wishes() if kind == "free-running" else Wishes(resample=10.0)
        return import_runs([path], kind, out, About(**about), wishes)

    return read


def _pilot(path: Path) -> Any:
    from swamp_rl.pilots import load_pilot

    pilot = load_pilot(path.parent)
    pilot.reset(2)
    return pilot.act(np.zeros((2, len(pilot.senses))))


def resealed(data: bytes) -> bytes:
    """A `pilot.json` with a seal that fits, as who changes one on purpose would write it."""
    import hashlib

    try:
        stored = json.loads(data)
        stored.pop("sha256", None)
        text = json.dumps(stored, indent=2) + "\n"
        stored["sha256"] = hashlib.sha256(text.encode()).hexdigest()
    except (ValueError, AttributeError, RecursionError, TypeError):
        return data
    return (json.dumps(stored, indent=2) + "\n").encode()


def _resealed_weights(path: Path) -> Any:
    """The pilot whose description was made to fit these weights."""
    import hashlib

    description = path.parent / "pilot.json"
    stored = json.loads(description.read_bytes())
    data = path.read_bytes()
    stored["weights"]["sha256"] = hashlib.sha256(data).hexdigest()
    description.write_bytes(resealed(json.dumps(stored).encode()))
    return _pilot(path)


def with_checksum(data: bytes) -> bytes:
    """Bytes with a mark of `swamp_rl.seal` that fits, if they have room for one."""
    import re

    from swamp_rl.seal import BLANK, MARK, sealed

    blank = re.sub(re.escape(MARK) + b"[0-9a-f]{64}", BLANK.encode(), data, count=1)
    try:
        return sealed(blank)
    except ValueError:
        return data


def _arrays(path: Path) -> Any:
    from swamp_rl.arrays_file import read_arrays

    return read_arrays(path)


def _trials(path: Path) -> Any:
    from swamp_rl.experiments.sweep.store import opened

    for left in path.parent.glob("*-journal"):
        left.unlink()
    with opened(path.parent, {"seed": 0}) as store:
        return store.trials()


def _row(path: Path) -> Any:
    import sqlite3

    from swamp_rl.experiments.sweep.store import FILE

    data = path.read_bytes()
    path.unlink()
    connection = sqlite3.connect(path.parent / FILE)
    with connection:
        try:
            value: Any = data.decode()
        except UnicodeDecodeError:
            value = data
        connection.execute("UPDATE trials SET trial = ? WHERE number = 1", (value,))
    connection.close()
    return _trials(path.parent / FILE)


def _onnx(path: Path) -> Any:
    from swamp_rl.export import OnnxPilot

    pilot = OnnxPilot(path)
    pilot.reset(1)
    return pilot


def _diagnosis(path: Path) -> Any:
    from swamp_rl.experiments.config.posterior import write_posterior

    return write_posterior(path, path.parent / "level.yaml")


def _unfinished(path: Path) -> Any:
    """The recorder's start on a folder in which a run was never finished."""
    from swamp_rl.runs.table import write_table
    from swamp_rl.teleop.recordings import Recordings

    data = path.read_bytes()
    for left in (*path.parent.parent.glob("*.csv"), *path.parent.parent.glob("*.yaml")):
        left.unlink()
    create_dataset(path.parent.parent, meta())
    write_table(path.with_suffix(".csv"), circle())
    path.write_bytes(data)
    Recordings(path.parent.parent, meta(), lambda line: None).close()


def _message(path: Path) -> Any:
    from swamp_rl.teleop.messages import clean_nickname, parse

    data = path.read_bytes()
    result = parse(data)
    with suppress(UnicodeDecodeError):
        result = parse(data.decode())
    return clean_nickname(getattr(result, "nickname", None) or "")


def _episodes(path: Path) -> Any:
    from swamp_rl.evaluation import read_episodes

    return read_episodes(path)


def _checkpoint(path: Path) -> Any:
    from swamp_rl.pilots.dagger_checkpoint import load_rounds

    return load_rounds(path, "task")


OTHERS = LOG_FORMATS | DESIGN_FORMATS | FOLDER_FORMATS | LINK_FORMATS
FORMATS: dict[str, Format] = {
    "experiment.yaml": Format(copied_config("experiments/learners.yaml"), _experiment),
    "--set": Format(make_text("evaluation.episodes=100"), _override),
    "sweep.yaml": Format(copied_config("sweeps/reservoir_search.yaml"), _sweep),
    "boat.yaml": Format(copied_config("boats/swamp.yaml"), _boat),
    "course.yaml": Format(copied_config("courses/camogli.yaml"), _course),
    "disturbances.yaml": Format(copied_config("disturbances/severe.yaml"), read_level),
    "trials.yaml": Format(copied_config("trials/ittc_swamp.yaml"), _plan),
    "dataset.yaml": Format(lambda folder: dataset_with(folder, "csv", "dataset.yaml"), _inspected),
    "run.csv": Format(lambda folder: dataset_with(folder, "csv", "one.csv"), _inspected),
    "run.parquet": Format(lambda folder: dataset_with(folder, "parquet", "one.parquet"), _inspected),
    "foreign.csv": Format(lambda folder: dataset_with(folder, "csv", "one.csv"), _imported("csv")),
    "run.mcap": Format(make_mcap, _imported("mcap")),
    "telemetry": Format(make_telemetry, _imported("telemetry")),
    "free-running.csv": Format(make_free_running, _imported("free-running")),
    "pilot.json": Format(make_pilot("pilot.json"), _pilot),
    "pilot.json, sealed anew": Format(make_pilot("pilot.json"), _pilot, resealed),
    "weights": Format(make_pilot(SAFETENSORS), _pilot),
    "weights, sealed anew": Format(make_pilot(SAFETENSORS), _resealed_weights),
    "checkpoint": Format(make_checkpoint, _checkpoint, with_checksum),
    "arrays.npz": Format(make_arrays, _arrays, with_checksum),
    "trials.sqlite": Format(make_trials, _trials),
    "trials.sqlite row": Format(make_row, _row, with_checksum),
    "pilot.onnx": Format(make_onnx, _onnx),
    "episodes.parquet": Format(make_episodes, _episodes),
    "diagnosis.json": Format(make_diagnosis, _diagnosis),
    "unfinished.json": Format(make_unfinished, _unfinished),
    "message": Format(make_message, _message),
    **{name: Format(*given) for name, given in OTHERS.items()},
}
