"""Folders of runs to be examined: our datasets, plain folders of tables, LeRobot's and Minari's."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.extras import missing
from swamp_rl.files import os_error
from swamp_rl.json_text import parsed_json, read_json
from swamp_rl.names import YAML, file_in
from swamp_rl.ordinary import ordinary
from swamp_rl.runs import Run
from swamp_rl.runs.apart import apart
from swamp_rl.runs.copies import boat_of, carried_boat
from swamp_rl.runs.dataset import inspect_dataset
from swamp_rl.runs.describe import is_table
from swamp_rl.runs.export_minari import COPIES
from swamp_rl.runs.schema import META, parsed_meta
from swamp_rl.runs.table import MOST_CELLS, read_table

Array = NDArray[np.float64]

MOST_FILES = 2_000
MINARI_FILE = "main_data.hdf5"


@dataclass(frozen=True)
class Records:
    """`runs` as far as they could be read; `boat`, where one is known; `faults` of format and range, a line
    each; `layout`: what the folder is; `measured`: whether sensors made the data."""

    runs: list[Run]
    layout: str
    boat: Boat | None = None
    faults: list[str] = field(default_factory=list)
    measured: bool = True


def read_records(folder: Path, boat: str | None = None) -> Records:
    """The runs of a folder of any of these layouts. UserError where it is none, or holds no run.

    boat: whose runs they are, where the folder does not say; without one the commands are examined by their
    names alone.
    """
    if not folder.is_dir():
        lacks = "is a file, not a folder of runs" if folder.exists() else "no such folder"
        raise UserError(f"{folder}: {lacks}; name a dataset")
    if (folder / "meta" / "info.json").is_file():
        found = _lerobot(folder, boat)
    elif minari := _minari_files(folder):
        found = _minari(folder, minari, boat)
    elif (folder / META).exists() or boat is not None:
        found = _dataset(folder, boat)
    else:
        found = _tables(folder)
    if not any(len(run.columns) for run in found.runs):
        first = f"; {found.faults[0]}" if found.faults else ""
        raise UserError(
            f"{folder}: no runs here{first}; name a folder of .csv or .parquet files, LeRobot's or Minari's; "
            "swamp-rl runs import makes one of logs"
        )
    return found


def _dataset(folder: Path, boat: str | None) -> Records:
    inspected = inspect_dataset(folder, boat)
    vessel = None
    if inspected.meta is not None:
        try:
            named = inspected.named_boat
            vessel = load_boat(named) if named else boat_of(folder, inspected.meta)
        except UserError as error:
            raise UserError(f"{folder}: its boat cannot be read: {error}") from error
    measured = inspected.meta is None or inspected.meta.source == "measured"
    faults = [str(fault) for fault in inspected.faults]
    runs = [run for run in inspected.runs if run.columns]
    return Records(runs, "dataset", vessel, faults, measured)


def _own(path: Path) -> Path:
    """The path, unless it leads elsewhere."""
    if path.is_symlink():
        raise UserError(f"{path}: is a link; put a copy of the file in its place")
    return path


def _tables(folder: Path) -> Records:
    """A plain folder without a boat."""
    paths = sorted(path for path in folder.iterdir() if is_table(path))[:MOST_FILES]
    tables = {path: read_table(_own(path)) for path in paths}
    faults = [str(fault) for table in tables.values() for fault in table.faults]
    timeless = [path for path, table in tables.items() if table.columns and "time" not in table.columns]
    faults += [
        f"{path.name}: has no column time; name it so, or import with --map time=COLUMN" for path in timeless
    ]
    empty = [path for path, table in tables.items() if table.columns and not len(table.rows)]
    faults += [f"{path.name}: holds no rows; record it again or remove it" for path in empty]
    runs = [Run(path.stem, table.columns) for path, table in tables.items() if "time" in table.columns]
    return Records(runs, "folder of tables", None, faults)


def _lerobot(folder: Path, boat: str | None) -> Records:
    """Episodes of LeRobot's layouts 2 and 3: frames in Parquet files, vectors with names in `info.json`."""
    info = _json(folder / "meta" / "info.json")
    features = info.get("features")
    features = features if isinstance(features, dict) else {}
    paths = sorted((folder / "data").rglob("*.parquet"))[:MOST_FILES]
    rate = info.get("fps")
    runs: list[Run] = []
    faults = [] if paths else ["its data has no .parquet file, copy it again"]
    for path in paths:
        columns = _frames(path, features)
        episodes = columns.pop("episode_index", np.zeros(len(next(iter(columns.values()), []))))
        known = np.isfinite(episodes)
        if not known.all():
            faults.append(f"{path.name}: {(~known).sum()} rows have no episode_index; they are left out")
        for number in np.unique(episodes[known]).tolist():
            taken = {name: values[episodes == number] for name, values in columns.items()}
            if "time" not in taken:
                taken["time"] = _times(taken, rate)
            runs.append(Run(f"episode-{int(number)}", taken))
    own = folder / "meta" / "swamp_rl.json"
    metadata = _json(own) if own.is_file() else {}
    vessel = _boat(folder / "meta", metadata, boat)
    return Records(runs, "LeRobot", vessel, faults, _measured(metadata))


def _measured(metadata: dict[str, Any]) -> bool:
    return metadata.get("source", "measured") == "measured"


def _times(columns: dict[str, Array], rate: Any) -> Array:
    if "timestamp" in columns:
        return columns["timestamp"]
    rows = len(next(iter(columns.values()), []))
    whole = isinstance(rate, int | float) and not isinstance(rate, bool) and rate > 0
    return np.arange(rows) / (float(rate) if whole else 1.0)


def _frames(path: Path, features: dict[str, Any]) -> dict[str, Array]:
    """Numeric columns, and each part of a vector as a column of its own, under its name where it has one."""
    try:
        file = pq.ParquetFile(ordinary(_own(path)))
        numbers = _declared_numbers(file.metadata)
        if numbers > MOST_CELLS:
            raise UserError(f"{path}: declares {numbers} numbers, at most {MOST_CELLS}; divide it")
        numeric = dict.fromkeys(one.name for one in file.schema_arrow if _is_number(_element(one.type)))
        data = file.read(columns=list(numeric))  # a few bytes of text may stand for any number of cells
        columns = list(zip(data.column_names, data.columns, strict=True))
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise os_error(error, path) from error
        raise UserError(f"{path}: cannot be read ({clipped(error, 200)}); copy it again") from error
    found: dict[str, Array] = {}
    for name, cells in columns:
        if _is_number(cells.type):
            found[name] = np.asarray(cells.to_numpy(), float)
        else:
            flat = np.asarray(cells.combine_chunks().flatten().to_numpy(zero_copy_only=False), float)
            if data.num_rows and len(flat) % data.num_rows == 0:
                parts = flat.reshape(data.num_rows, -1).T
                names = _part_names(name, features.get(name), len(parts))
                found |= {
                    part: values for part, values in zip(names, parts, strict=True) if part not in found
                }
    return found


def _declared_numbers(metadata: Any) -> int:
    """Cells of a Parquet file and elements of its lists: a few bytes may hold any number."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    held = sum(group.column(i).num_values for group in groups for i in range(group.num_columns))
    return max(held, metadata.num_rows * metadata.num_columns)


def _element(kind: Any) -> Any:
    """The type of a list's elements, or that of a single cell."""
    return kind.value_type if pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind) else kind


def _is_number(kind: Any) -> bool:
    return pa.types.is_integer(kind) or pa.types.is_floating(kind)


def _part_names(name: str, feature: Any, count: int) -> list[str]:
    names = feature.get("names") if isinstance(feature, dict) else None
    if isinstance(names, dict) and len(names) == 1:
        names = next(iter(names.values()))
    if isinstance(names, list) and len(names) == count and all(isinstance(one, str) for one in names):
        return names
    return [f"{name}[{i}]" for i in range(count)]


def _minari_files(folder: Path) -> list[Path]:
    """The data of the Minari datasets in a folder: itself, its `data`, or a root of datasets."""
    places = [folder, folder / "data", *sorted(folder.glob("*/data")), *sorted(folder.glob("*/*/data"))]
    return [path for place in places if (path := place / MINARI_FILE).is_file()][:MOST_FILES]


def _minari(folder: Path, paths: list[Path], boat: str | None) -> Records:
    runs: list[Run] = []
    vessel, measured = None, True
    for path in paths:
        try:
            ordinary(_own(path), 2**33)
        except OSError as error:
            raise os_error(error, path) from error
        episodes, metadata, copies = _minari_episodes(path)
        runs += [Run(name, columns) for name, columns in episodes]
        measured = measured and _measured(metadata)
        vessel = vessel or _minari_boat(path, metadata, copies, boat)
    return Records(runs, "Minari", vessel, measured=measured)


def _minari_boat(
    path: Path, metadata: dict[str, Any], copies: dict[str, Any], boat: str | None
) -> Boat | None:
    """The named boat, else that of the copies in the metadata, else the shipped one of that name."""
    if boat is not None or not copies:
        return _boat_named(metadata, boat)
    try:
        return carried_boat(
            parsed_meta(metadata), {name: str(text).encode() for name, text in copies.items()}
        )
    except (UserError, ValueError) as error:
        raise UserError(f"{path}: its boat cannot be read ({clipped(error, 200)}); give --boat") from error


def _boat_named(metadata: dict[str, Any], boat: str | None) -> Boat | None:
    """The boat that was named, else the shipped one of the dataset's name; None where there is none."""
    name = boat or metadata.get("vehicle")
    if not isinstance(name, str):
        return None
    try:
        return load_boat(name)
    except UserError:
        if boat is not None:
            raise
        return None


def _boat(folder: Path, metadata: dict[str, Any], boat: str | None) -> Boat | None:
    """The named boat, else the copy beside the description, else the shipped one of that name."""
    try:
        copy = file_in(folder, f"{metadata.get('vehicle')}.yaml", YAML)
    except UserError:
        return _boat_named({}, boat)
    return load_boat(copy) if boat is None and copy.is_file() else _boat_named(metadata, boat)


@apart
def _minari_episodes(
    path: Path,
) -> tuple[list[tuple[str, dict[str, Array]]], dict[str, Any], dict[str, Any]]:
    """Episodes as columns: those of `infos`, where these have a time, else of observations and actions; what
    the metadata tell of the dataset, and the texts of the boat's and the course's files.

    In a process of its own, which a damaged HDF5 file may end.
    """
    try:
        import h5py
    except ImportError as error:
        raise missing("Minari's files need h5py", "exchange") from error
    found, most = [], MOST_CELLS
    try:
        with h5py.File(path, "r") as file:
            for name in sorted(file, key=lambda key: (len(key), key)):
                group = _held(file, name)
                if isinstance(group, h5py.Group):
                    columns, read = _episode(group, most)
                    most -= read
                    found.append((name, columns))
        meta = path.with_name("metadata.json")
        described = _json(meta) if meta.is_file() else {}
        texts = [described.get(key, "{}") for key in ("swamp_rl", COPIES)]
        about, copies = (parsed_json(text) if isinstance(text, str) else {} for text in texts)
    except (AttributeError, KeyError, OSError, RuntimeError, TypeError, ValueError) as error:
        raise UserError(
            f"{path}: is not a complete Minari file ({clipped(error, 200)}); copy it again"
        ) from error
    about, copies = (one if isinstance(one, dict) else {} for one in (about, copies))
    return found, about, copies


def _episode(group: Any, most: int) -> tuple[dict[str, Array], int]:
    """The columns of an episode, and how many numbers were read; ValueError for more than `most`."""
    import h5py

    infos = _held(group, "infos")
    if isinstance(infos, h5py.Group) and "time" in infos:
        held = {name: _held(infos, name) for name in infos}
        shape = held["time"].shape
        found = _numbers({n: one for n, one in held.items() if one.shape == shape and one.ndim == 1}, most)
        return found, sum(map(len, found.values()))
    parts = {name[:-1]: _held(group, name) for name in ("observations", "actions")}
    found = _numbers({name: one for name, one in parts.items() if isinstance(one, h5py.Dataset)}, most)
    rows = min(map(len, found.values()), default=0)
    flat = {name: values.reshape(len(values), -1)[:rows].T for name, values in found.items()}
    columns = {f"{name}[{i}]": part for name, values in flat.items() for i, part in enumerate(values)}
    time = {"time": np.arange(rows, dtype=float)} if columns else {}
    return columns | time, sum(values.size for values in found.values())


def _held(group: Any, name: str) -> Any:
    """What a group holds under a name, None where there is none; ValueError where it lies elsewhere."""
    import h5py

    link = group.get(name, getlink=True)
    if link is None:
        return None
    if not isinstance(link, h5py.HardLink):
        raise ValueError(f"{name!r} is a link")
    held = group[name]
    if isinstance(held, h5py.Dataset) and (held.external or held.is_virtual):
        raise ValueError(f"the values of {name!r} are in another file")
    return held


def _numbers(held: dict[str, Any], most: int) -> dict[str, Array]:
    """The numbers of datasets. A small file may claim any number of them, any width, and any chunk, which is
    unpacked whole."""
    for name, one in held.items():
        if one.dtype.kind not in "biuf":
            raise ValueError(f"{name!r} has no plain numbers")
        if math.prod(one.chunks or ()) > MOST_CELLS:
            raise ValueError(f"{name!r} is stored in chunks of more than {MOST_CELLS} numbers")
    if sum(one.size for one in held.values()) > most:
        raise ValueError(f"its episodes have more than {MOST_CELLS} numbers")
    return {name: np.asarray(one[()], float) for name, one in held.items()}


def _json(path: Path) -> dict[str, Any]:
    return read_json(_own(path), "restore it")
