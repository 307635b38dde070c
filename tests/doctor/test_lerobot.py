"""A stranger's frames of LeRobot, in Parquet, take no more memory than the doctor allows."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from swamp_rl.doctor.read import MOST_CELLS, read_records
from swamp_rl.errors import UserError


def _frames(folder: Path, columns: dict[str, pa.Array]) -> None:
    for name in ("meta", "data"):
        (folder / name).mkdir()
    (folder / "meta" / "info.json").write_text(json.dumps({"fps": 10, "features": {}}))
    pq.write_table(pa.table(columns), folder / "data" / "frames.parquet", store_schema=False)


def test_lists_of_more_numbers_than_are_read_are_refused_before_they_are_read(tmp_path: Path) -> None:
    ends = np.linspace(0, MOST_CELLS, 3, dtype=np.int32)
    action = pa.ListArray.from_arrays(ends, np.zeros(MOST_CELLS, np.int8))
    _frames(tmp_path, {"timestamp": pa.array([0.0, 0.1]), "action": action})
    assert (tmp_path / "data" / "frames.parquet").stat().st_size < 10_000
    with pytest.raises(UserError, match=r"frames\.parquet: declares 40000002 numbers"):
        read_records(tmp_path)


def test_a_text_that_is_no_number_is_not_unpacked(tmp_path: Path) -> None:
    rows = 50_000
    task = pa.DictionaryArray.from_arrays(np.zeros(rows, np.int32), ["x" * 10_000])
    _frames(tmp_path, {"timestamp": pa.array(np.arange(rows) / 10.0), "task": task})
    before = pa.default_memory_pool().max_memory()
    (run,) = read_records(tmp_path).runs
    assert len(run.columns["time"]) == rows
    assert pa.default_memory_pool().max_memory() - before < 100e6
