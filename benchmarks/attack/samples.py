"""A good file of each format, put into a folder; what an attack then damages."""

import functools
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl import files, yaml_text
from swamp_rl.runs import DatasetMeta, Run, RunMeta, append_run, create_dataset

CONFIGS = Path(__file__).parents[2] / "configs"
THRUSTERS = ("bs", "bp", "ss", "sp")


def parse_once() -> None:
    """Have this process parse each YAML text once: most of the time of an attack would go into files that it
    leaves as they are, and those of boats are long."""

    @functools.lru_cache(maxsize=64)
    def remembered(text: str) -> bytes:
        return pickle.dumps(yaml_text.parsed(text))

    files.parsed = lambda text: pickle.loads(remembered(text))


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
    return Run("one", circle(), RunMeta(seed=1, outcome="success", initial_state={"north": 0.0}, group="may"))


def copied_config(source: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / "file.yaml").write_bytes((CONFIGS / source).read_bytes())
        return folder / "file.yaml"

    return make


def make_boat(kind: Any) -> Callable[[Path], Path]:
    """A boat file by estimates, `boat.yaml`."""

    def make(folder: Path) -> Path:
        from swamp_rl.boat.estimate import annotated, boat_file

        content = boat_file("new", kind, 1.2, 0.48, 35.0, 70.0)
        (folder / "boat.yaml").write_text(annotated(content, "a test"))
        return folder / "boat.yaml"

    return make


def dataset_with(folder: Path, kind: Any, name: str) -> Path:
    create_dataset(folder / "runs", meta())
    append_run(folder / "runs", run(), kind)
    return folder / "runs" / name


def make_mcap(folder: Path) -> Path:
    from swamp_rl.runs.mcap_files import write_mcap

    write_mcap(folder / "one.mcap", run(), meta())
    return folder / "one.mcap"


def make_telemetry(folder: Path) -> Path:
    from swamp_rl.runs.import_telemetry import FIELDS

    lines = []
    for i in range(5):
        values = dict.fromkeys(FIELDS, "0.5") | {"sender": "1", "position_flags": "1", "velocity_flags": "1"}
        values |= {"utc": str(1_700_000_000_000 + 100 * i), "utc_flags": "1"}
        lines.append(" ".join(values.values()))
    (folder / "one.txt").write_text("\n".join(lines) + "\n")
    return folder / "one.txt"


def make_free_running(folder: Path) -> Path:
    from swamp_rl.runs.free_running import COLUMNS

    rows = [",".join(str(0.1 * i) for _ in COLUMNS) for i in range(6)]
    (folder / "one.csv").write_text("\n".join([",".join(COLUMNS), *rows]) + "\n")
    return folder / "one.csv"


def make_pilot(name: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        from swamp_rl.pilots import save_pilot
        from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

        pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
        save_pilot(pilot, folder / "pilot")
        return folder / "pilot" / name

    return make


def make_arrays(folder: Path) -> Path:
    from swamp_rl.arrays_file import write_arrays

    write_arrays(folder / "one.npz", {"table/seed": np.arange(4), "pose": np.ones((2, 3))})
    return folder / "one.npz"


def make_trials(folder: Path) -> Path:
    from swamp_rl.experiments.sweep.store import FILE, Trial, opened

    with opened(folder / "sweep", {"seed": 0}) as store:
        for number in range(3):
            store.add(Trial(number, {"a": 1.0}, 0.5, {"mean": 1.0}, None, 1, 0.1))
    return folder / "sweep" / FILE


def make_row(folder: Path) -> Path:
    import sqlite3

    path = make_trials(folder)
    with sqlite3.connect(path) as connection:
        (row,) = connection.execute("SELECT trial FROM trials WHERE number = 1").fetchone()
    (path.parent / "row").write_text(row)
    return path.parent / "row"


def make_onnx(folder: Path) -> Path:
    from swamp_rl.export import write_onnx
    from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

    pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
    write_onnx(pilot, folder / "pilot.onnx")
    return folder / "pilot.onnx"


def make_diagnosis(folder: Path) -> Path:
    empty: dict[str, Any] = {
        name: [] for name in ("indistinguishable", "contrasts", "leftover", "candidates")
    }
    empty |= {"unseen": [], "gain": [], "noise": {}, "adequacy": {}, "elapsed_s": 1.0}
    speed = {"value": 0.2, "standard_error": 0.05, "unit": "m/s"}
    numbers = {"north": speed, "east": speed}
    entries = {"verdict": "cause", "separating_trial": None, "correlation": [[1.0, 0.2], [0.2, 1.0]]}
    entries["causes"] = [{"effect": "current", "parameters": numbers}]
    (folder / "diagnosis.json").write_text(json.dumps(empty | entries))
    return folder / "diagnosis.json"


def make_unfinished(folder: Path) -> Path:
    from swamp_rl.teleop.journal import write_description

    create_dataset(folder / "runs", meta())
    (folder / "runs" / "unfinished").mkdir()
    entries = {"seed": 3, "outcome": "success", "nickname": "x", "accepted": True}
    write_description(folder / "runs" / "unfinished" / "one.json", entries)
    return folder / "runs" / "unfinished" / "one.json"


def make_message(folder: Path) -> Path:
    (folder / "message").write_text('{"type": "command", "throttle": 0.5, "angle": -0.2, "live": true}')
    return folder / "message"


def make_episodes(folder: Path) -> Path:
    from swamp_rl.evaluation import write_episodes
    from swamp_rl.evaluation.episodes import COLUMNS

    table = {name: np.arange(3.0) for name in COLUMNS}
    table |= {"seed": np.arange(3), "success": np.array([True, False, True])}
    table["outcome"] = np.array(["success", "buoy", "success"])
    write_episodes(folder / "episodes.parquet", {("a", "calm"): table})
    return folder / "episodes.parquet"


def make_checkpoint(folder: Path) -> Path:
    from swamp_rl.pilots.dagger_checkpoint import Rounds, save_rounds
    from swamp_rl.pilots.reservoir import ReservoirSettings, untrained_reservoir

    pilot = untrained_reservoir(np.random.default_rng(0), ReservoirSettings(units=5))
    save_rounds(folder / "rounds", Rounds([run()], [1], pilot, pilot), "task")
    return folder / "rounds"


def make_text(text: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / "text").write_text(text)
        return folder / "text"

    return make
