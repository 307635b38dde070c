"""Every format that the package reads: how a good file of it is made, and the reader that meets a bad one."""

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.runs import DatasetMeta, Run, RunMeta, append_run, create_dataset

CONFIGS = Path(__file__).parents[2] / "configs"
SAFETENSORS = "weights.safetensors"
THRUSTERS = ("bs", "bp", "ss", "sp")


@dataclass(frozen=True)
class Format:
    """One format: `make` puts a good file into a folder and returns its path; `read` reads the file there.
    `disguise` makes bytes look whole where a checksum would stop them before the parser."""

    make: Callable[[Path], Path]
    read: Callable[[Path], Any]
    disguise: Callable[[bytes], bytes] = bytes


def outcome(format: Format, path: Path, data: bytes) -> str:
    """`accepted` or `refused` when the reader meets `data` at `path`; any other exception is let through.

    AssertionError where the refusal is more than one line, or too long to be read.
    """
    path.write_bytes(format.disguise(data))
    try:
        format.read(path)
    except UserError as error:
        line = str(error)
        assert "\n" not in line and len(line) < 3000, f"no one short line: {line[:200]!r}"
        return "refused"
    return "accepted"


def circle(rows: int = 12) -> dict[str, np.ndarray]:
    """Columns of a run in the run format."""
    time = np.arange(rows) / 10.0
    columns = {"time": time, "north": np.sin(time), "east": np.cos(time), "heading": np.zeros(rows)}
    columns |= {"surge": np.full(rows, 0.5), "sway": np.zeros(rows), "yaw_rate": np.full(rows, 0.1)}
    columns |= {f"azimuth_{name}": np.zeros(rows) for name in THRUSTERS}
    return columns | {f"throttle_{name}": np.full(rows, 0.5) for name in THRUSTERS}


def meta() -> DatasetMeta:
    """Of a dataset of such runs."""
    return DatasetMeta(
        vehicle="swamp", mass=58.0, draught=0.14, water_density=1025.0, sample_rate=10.0, source="simulated"
    )


def run() -> Run:
    """One such run."""
    return Run("one", circle(), RunMeta(seed=1, outcome="success", initial_state={"north": 0.0}))


def _copy(source: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / "file.yaml").write_bytes((CONFIGS / source).read_bytes())
        return folder / "file.yaml"

    return make


def _dataset(folder: Path, kind: Any, name: str) -> Path:
    create_dataset(folder / "runs", meta())
    append_run(folder / "runs", run(), kind)
    return folder / "runs" / name


def _experiment(path: Path) -> Any:
    from swamp_rl.experiments.schema import load_experiment

    return load_experiment(path)


def _override(path: Path) -> Any:
    from swamp_rl.experiments.schema import load_experiment

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


def _level(path: Path) -> Any:
    from swamp_rl.effects import load_disturbances

    return load_disturbances(path, THRUSTERS)


def _plan(path: Path) -> Any:
    from swamp_rl.manoeuvres.plan import load_plan

    return load_plan(path).singly


def _inspected(path: Path) -> Any:
    from swamp_rl.runs import read_dataset

    return read_dataset(path.parent)


def _make_mcap(folder: Path) -> Path:
    from swamp_rl.runs.mcap_files import write_mcap

    write_mcap(folder / "one.mcap", run(), meta())
    return folder / "one.mcap"


def _imported(kind: Any, **about: Any) -> Callable[[Path], Any]:
    def read(path: Path) -> Any:
        import shutil

        from swamp_rl.runs.import_dataset import About, import_runs
        from swamp_rl.runs.import_foreign import Wishes

        out = path.parent / "imported"
        shutil.rmtree(out, ignore_errors=True)
        return import_runs([path], kind, out, About(**about), Wishes(resample=10.0))

    return read


def _make_telemetry(folder: Path) -> Path:
    from swamp_rl.runs.import_telemetry import FIELDS

    lines = []
    for i in range(5):
        values = dict.fromkeys(FIELDS, "0.5") | {"sender": "1", "position_flags": "1", "velocity_flags": "1"}
        values |= {"utc": str(1_700_000_000_000 + 100 * i), "utc_flags": "1"}
        lines.append(" ".join(values.values()))
    (folder / "one.txt").write_text("\n".join(lines) + "\n")
    return folder / "one.txt"


def _make_free_running(folder: Path) -> Path:
    from swamp_rl.runs.free_running import COLUMNS

    rows = [",".join(str(0.1 * i) for _ in COLUMNS) for i in range(6)]
    (folder / "one.csv").write_text("\n".join([",".join(COLUMNS), *rows]) + "\n")
    return folder / "one.csv"


def _make_pilot(name: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        from swamp_rl.pilots import save_pilot
        from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

        pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
        save_pilot(pilot, folder / "pilot")
        return folder / "pilot" / name

    return make


def _pilot(path: Path) -> Any:
    from swamp_rl.pilots import load_pilot

    pilot = load_pilot(path.parent)
    pilot.reset(2)
    return pilot.act(np.zeros((2, len(pilot.senses))))


def resealed(data: bytes) -> bytes:
    """A `pilot.json` with a seal that fits, as who changes one on purpose would write it."""
    import hashlib

    try:
        told = json.loads(data)
        told.pop("sha256", None)
        text = json.dumps(told, indent=2) + "\n"
        told["sha256"] = hashlib.sha256(text.encode()).hexdigest()
    except (ValueError, AttributeError, RecursionError, TypeError):
        return data
    return (json.dumps(told, indent=2) + "\n").encode()


def _resealed_weights(path: Path) -> Any:
    """The pilot whose description was made to fit these weights."""
    import hashlib

    description = path.parent / "pilot.json"
    told = json.loads(description.read_bytes())
    data = path.read_bytes()
    told["weights"]["sha256"] = hashlib.sha256(data).hexdigest()
    description.write_bytes(resealed(json.dumps(told).encode()))
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


def _make_arrays(folder: Path) -> Path:
    from swamp_rl.arrays_file import write_arrays

    write_arrays(folder / "one.npz", {"table/seed": np.arange(4), "pose": np.ones((2, 3))})
    return folder / "one.npz"


def _arrays(path: Path) -> Any:
    from swamp_rl.arrays_file import read_arrays

    return read_arrays(path)


def _make_trials(folder: Path) -> Path:
    from swamp_rl.experiments.sweep.store import FILE, Trial, opened

    with opened(folder / "sweep", {"seed": 0}) as store:
        for number in range(3):
            store.add(Trial(number, {"a": 1.0}, 0.5, {"mean": 1.0}, None, 1, 0.1))
    return folder / "sweep" / FILE


def _trials(path: Path) -> Any:
    from swamp_rl.experiments.sweep.store import opened

    for left in path.parent.glob("*-journal"):
        left.unlink()
    with opened(path.parent, {"seed": 0}) as store:
        return store.trials()


def _make_row(folder: Path) -> Path:
    import sqlite3

    path = _make_trials(folder)
    with sqlite3.connect(path) as connection:
        (row,) = connection.execute("SELECT trial FROM trials WHERE number = 1").fetchone()
    (path.parent / "row").write_text(row)
    return path.parent / "row"


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


def _make_onnx(folder: Path) -> Path:
    from swamp_rl.export import write_onnx
    from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

    pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
    write_onnx(pilot, folder / "pilot.onnx")
    return folder / "pilot.onnx"


def _onnx(path: Path) -> Any:
    from swamp_rl.export import OnnxPilot

    pilot = OnnxPilot(path)
    pilot.reset(1)
    return pilot


def _make_diagnosis(folder: Path) -> Path:
    empty: dict[str, Any] = {
        name: [] for name in ("indistinguishable", "contrasts", "leftover", "candidates")
    }
    empty |= {"unseen": [], "gain": [], "noise": {}, "adequacy": {}, "elapsed_s": 1.0}
    speed = {"value": 0.2, "standard_error": 0.05, "unit": "m/s"}
    numbers = {"north": speed, "east": speed}
    told = {"verdict": "cause", "separating_trial": None, "correlation": [[1.0, 0.2], [0.2, 1.0]]}
    told["causes"] = [{"effect": "current", "parameters": numbers}]
    (folder / "diagnosis.json").write_text(json.dumps(empty | told))
    return folder / "diagnosis.json"


def _make_curve(folder: Path) -> Path:
    points = [{"step": i, "success": 0.1 * i, "seconds": 1.0} for i in range(4)]
    (folder / "curve.jsonl").write_text("".join(json.dumps(point) + "\n" for point in points))
    return folder / "curve.jsonl"


def _curve(path: Path) -> Any:
    from swamp_rl.experiments.curves import read_curve

    return read_curve(path)


def _diagnosis(path: Path) -> Any:
    from swamp_rl.criticism.posterior import write_posterior

    return write_posterior(path, path.parent / "level.yaml")


def _make_unfinished(folder: Path) -> Path:
    from swamp_rl.teleop.journal import write_description

    create_dataset(folder / "runs", meta())
    (folder / "runs" / "unfinished").mkdir()
    told = {"seed": 3, "outcome": "success", "nickname": "x", "accepted": True}
    write_description(folder / "runs" / "unfinished" / "one.json", told)
    return folder / "runs" / "unfinished" / "one.json"


def _unfinished(path: Path) -> Any:
    """The recorder's start on a folder in which a run was never finished."""
    from swamp_rl.runs.table import write_table
    from swamp_rl.teleop.recordings import Recordings

    data = path.read_bytes()
    for left in path.parent.parent.glob("*.csv"):
        left.unlink()
    create = path.parent.parent / "dataset.yaml"
    create.unlink()
    create_dataset(path.parent.parent, meta())
    write_table(path.with_suffix(".csv"), circle())
    path.write_bytes(data)
    Recordings(path.parent.parent, meta(), lambda line: None).close()


def _make_message(folder: Path) -> Path:
    (folder / "message").write_text('{"type": "command", "throttle": 0.5, "angle": -0.2, "live": true}')
    return folder / "message"


def _message(path: Path) -> Any:
    from swamp_rl.teleop.messages import clean_nickname, parse

    data = path.read_bytes()
    told = parse(data)
    with suppress(UnicodeDecodeError):
        told = parse(data.decode())
    return clean_nickname(getattr(told, "nickname", None) or "")


def _make_episodes(folder: Path) -> Path:
    from swamp_rl.evaluation import write_episodes
    from swamp_rl.evaluation.episodes import COLUMNS

    table = {name: np.arange(3.0) for name in COLUMNS}
    table |= {"seed": np.arange(3), "success": np.array([True, False, True])}
    write_episodes(folder / "episodes.parquet", {("a", "calm"): table})
    return folder / "episodes.parquet"


def _episodes(path: Path) -> Any:
    from swamp_rl.evaluation import read_episodes

    return read_episodes(path)


def _make_checkpoint(folder: Path) -> Path:
    from swamp_rl.pilots.dagger_checkpoint import Rounds, save_rounds
    from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

    pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
    save_rounds(folder / "rounds", Rounds([run()], [1], pilot, pilot), "task")
    return folder / "rounds"


def _checkpoint(path: Path) -> Any:
    from swamp_rl.pilots.dagger_checkpoint import load_rounds

    return load_rounds(path, "task")


def _make_text(text: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / "text").write_text(text)
        return folder / "text"

    return make


FORMATS: dict[str, Format] = {
    "experiment.yaml": Format(_copy("experiments/learners.yaml"), _experiment),
    "--set": Format(_make_text("evaluation.episodes=100"), _override),
    "sweep.yaml": Format(_copy("sweeps/reservoir_search.yaml"), _sweep),
    "boat.yaml": Format(_copy("boats/swamp.yaml"), _boat),
    "course.yaml": Format(_copy("courses/camogli.yaml"), _course),
    "disturbances.yaml": Format(_copy("disturbances/severe.yaml"), _level),
    "trials.yaml": Format(_copy("trials/ittc_swamp.yaml"), _plan),
    "dataset.yaml": Format(lambda folder: _dataset(folder, "csv", "dataset.yaml"), _inspected),
    "run.csv": Format(lambda folder: _dataset(folder, "csv", "one.csv"), _inspected),
    "run.parquet": Format(lambda folder: _dataset(folder, "parquet", "one.parquet"), _inspected),
    "foreign.csv": Format(lambda folder: _dataset(folder, "csv", "one.csv"), _imported("csv")),
    "run.mcap": Format(_make_mcap, _imported("mcap")),
    "telemetry": Format(_make_telemetry, _imported("telemetry")),
    "free-running.csv": Format(_make_free_running, _imported("free-running")),
    "pilot.json": Format(_make_pilot("pilot.json"), _pilot),
    "pilot.json, sealed anew": Format(_make_pilot("pilot.json"), _pilot, resealed),
    "weights": Format(_make_pilot(SAFETENSORS), _pilot),
    "weights, sealed anew": Format(_make_pilot(SAFETENSORS), _resealed_weights),
    "checkpoint": Format(_make_checkpoint, _checkpoint, with_checksum),
    "arrays.npz": Format(_make_arrays, _arrays, with_checksum),
    "trials.sqlite": Format(_make_trials, _trials),
    "trials.sqlite row": Format(_make_row, _row, with_checksum),
    "pilot.onnx": Format(_make_onnx, _onnx),
    "episodes.parquet": Format(_make_episodes, _episodes),
    "curve.jsonl": Format(_make_curve, _curve),
    "diagnosis.json": Format(_make_diagnosis, _diagnosis),
    "unfinished.json": Format(_make_unfinished, _unfinished),
    "message": Format(_make_message, _message),
}
