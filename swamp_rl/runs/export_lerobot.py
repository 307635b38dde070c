"""A dataset in the layout of LeRobot, version 3.0: Parquet frames of episodes, and what describes them."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.runs.dataset import Dataset
from swamp_rl.runs.episodes_of import Split, split_columns
from swamp_rl.runs.run import Run

VERSION = "v3.0"
FILE = "chunk-000/file-{:03d}.parquet"
FILE_SIZE, CHUNK, VIDEO_SIZE = 100, 1000, 500
"""MB of frames in a file, files in a folder, and what LeRobot wants to know of videos, too."""
STATE, ACTION = "observation.state", "action"
COUNTED = ("frame_index", "episode_index", "index", "task_index")

Frames = dict[str, NDArray[Any]]


def write_lerobot(dataset: Dataset, folder: Path, copies: Mapping[str, bytes]) -> None:
    """Write `meta/` and `data/` into a folder.

    `observation.state` and `action` are vectors of float64; every other column is a feature of its own under
    its name, and what dataset.yaml says is in `meta/swamp_rl.json`, with the `copies` of boat and course
    beside it: a run comes back bit for bit but for
    `timestamp`, which LeRobot has as float32 counted from the frames. UserError where the rate is no whole
    number, which LeRobot needs, or a column has the name of one of its features.
    """
    rate = round(dataset.meta.sample_rate)
    if abs(dataset.meta.sample_rate - rate) > 1e-9 * rate or rate < 1:
        raise UserError(
            f"{dataset.folder}: LeRobot counts whole frames a second, not "
            f"{dataset.meta.sample_rate:g}; resample the runs"
        )
    split = split_columns(dataset)
    taken = set(split.others) & {STATE, ACTION, "timestamp", *COUNTED}
    if taken:
        raise UserError(f"{dataset.folder}: column {min(taken)} has another meaning in LeRobot; rename it")
    (folder / "meta").mkdir(parents=True)
    episodes, sums = _write_frames(dataset, folder, split, rate)
    task = f"pass the gates of {Path(dataset.meta.course).stem}" if dataset.meta.course else "drive the boat"
    _write_episodes(folder, episodes, task)
    _write_tasks(folder / "meta" / "tasks.parquet", task)
    _write_json(folder / "meta" / "stats.json", sums)
    _write_json(folder / "meta" / "info.json", _info(dataset, split, rate))
    metadata = dataset.meta.model_dump(exclude_none=True, exclude={"runs"})
    runs = [
        {"name": run.name, **run.meta.model_dump(exclude_none=True, exclude={"file"})} for run in dataset.runs
    ]
    _write_json(folder / "meta" / "swamp_rl.json", metadata | {"runs": runs})
    for name, held in copies.items():
        (folder / "meta" / name).write_bytes(held)


def _write_json(path: Path, data: dict[str, Any]) -> None:
    path.write_text(json.dumps(data, indent=4, allow_nan=False) + "\n", encoding="utf-8")


def _info(dataset: Dataset, split: Split, rate: int) -> dict[str, Any]:
    features: dict[str, Any] = {
        STATE: _feature("float64", split.state),
        ACTION: _feature("float64", split.action),
    }
    features |= {name: _feature("float64") for name in split.others}
    features["timestamp"] = _feature("float32")
    features |= {name: _feature("int64") for name in COUNTED}
    frames = sum(len(run.time) for run in dataset.runs)
    return {
        "codebase_version": VERSION,
        "robot_type": Path(dataset.meta.vehicle).stem,
        "total_episodes": len(dataset.runs),
        "total_frames": frames,
        "total_tasks": 1,
        "chunks_size": CHUNK,
        "data_files_size_in_mb": FILE_SIZE,
        "video_files_size_in_mb": VIDEO_SIZE,
        "fps": rate,
        "splits": {"train": f"0:{len(dataset.runs)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": features,
    }


def _feature(kind: str, names: tuple[str, ...] | None = None) -> dict[str, Any]:
    return {"dtype": kind, "shape": [len(names) if names else 1], "names": list(names) if names else None}


def _frames(dataset: Dataset, split: Split, rate: int) -> Iterator[Frames]:
    """The frames of each episode in turn."""
    first = 0
    for number, run in enumerate(dataset.runs):
        yield _episode(run, split, rate, number, first)
        first += len(run.time)


def _episode(run: Run, split: Split, rate: int, number: int, first: int) -> Frames:
    count = np.arange(len(run.time))
    frames: Frames = {STATE: run.stacked(split.state), ACTION: run.stacked(split.action)}
    frames |= {name: run.columns[name] for name in split.others}
    return frames | {
        "timestamp": (count / rate).astype(np.float32),
        "frame_index": count,
        "episode_index": np.full(len(count), number),
        "index": first + count,
        "task_index": np.zeros(len(count), np.int64),
    }


def _write_frames(
    dataset: Dataset, folder: Path, split: Split, rate: int
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Files of about `FILE_SIZE`, a row group for each episode; the episodes' places, and all statistics."""
    import pyarrow.parquet as pq

    episodes, everything = [], []
    writer, number, written = None, -1, 0
    try:
        for frames in _frames(dataset, split, rate):
            table = _arrow(frames)
            if writer is None or written + table.nbytes > FILE_SIZE * 1024**2:
                if writer is not None:
                    writer.close()
                number, written = number + 1, 0
                path = folder / "data" / FILE.format(number)
                path.parent.mkdir(parents=True, exist_ok=True)
                writer = pq.ParquetWriter(path, table.schema, write_page_checksum=True)
            writer.write_table(table)
            written += table.nbytes
            statistics = _statistics(frames)
            everything.append(frames)
            place = {
                "episode_index": int(frames["episode_index"][0]),
                "length": len(frames["index"]),
                "data/chunk_index": 0,
                "data/file_index": number,
                "dataset_from_index": int(frames["index"][0]),
                "dataset_to_index": int(frames["index"][-1]) + 1,
            }
            flat = {
                f"stats/{name}/{what}": value for name, of in statistics.items() for what, value in of.items()
            }
            episodes.append(place | flat)
    finally:
        if writer is not None:
            writer.close()
    joined = {name: np.concatenate([frames[name] for frames in everything]) for name in everything[0]}
    return episodes, _statistics(joined)


def _arrow(frames: Frames) -> Any:
    import pyarrow as pa

    columns = {}
    for name, values in frames.items():
        if values.ndim == 2:
            flat = pa.array(np.ascontiguousarray(values).reshape(-1))
            columns[name] = pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
        else:
            columns[name] = pa.array(np.ascontiguousarray(values))
    return pa.table(columns)


def _statistics(frames: Frames) -> dict[str, dict[str, list[float]]]:
    """By feature: least, greatest, mean and spread of each of its numbers, and how many frames there are."""
    found = {}
    for name, values in frames.items():
        columns = values.reshape(len(values), -1).astype(float)
        found[name] = {
            "min": columns.min(axis=0).tolist(),
            "max": columns.max(axis=0).tolist(),
            "mean": columns.mean(axis=0).tolist(),
            "std": columns.std(axis=0).tolist(),
            "count": [len(columns)],
        }
    return found


def _write_episodes(folder: Path, episodes: list[dict[str, Any]], task: str) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    path = folder / "meta" / "episodes" / FILE.format(0)
    path.parent.mkdir(parents=True)
    here = {"tasks": [task], "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
    pq.write_table(pa.Table.from_pylist([here | episode for episode in episodes]), path)


def _write_tasks(path: Path, task: str) -> None:
    """As pandas writes a table whose index is the task's words: so LeRobot reads it."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    def column(name: str, kind: str, numpy_kind: str) -> dict[str, Any]:
        return {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy_kind,
            "metadata": None,
        }

    metadata = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [column("task_index", "int64", "int64"), column("task", "unicode", "object")],
        "pandas_version": "2.2.0",
    }
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": pa.array([task])})
    pq.write_table(table.replace_schema_metadata({"pandas": json.dumps(metadata)}), path)
