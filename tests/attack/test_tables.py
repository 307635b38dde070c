"""Tables whose few bytes ask for much time or memory are refused, as a fault of the file."""

import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from mcap.writer import Writer

from swamp_rl.errors import UserError
from swamp_rl.runs.mcap_files import MOST_BYTES, read_mcap
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS, read_table, write_table

HEADERS = {
    "many names": b",".join(b"c%d" % i for i in range(300_000)) + b"\n1\n",
    "one name many times": b"x," * 300_000 + b"\n1\n",
    "a long name": b"x" * 5_000_000 + b"\n1\n",
    "a quote that is never closed": b'"' + b"x" * 5_000_000,
    "null bytes": b"\0" * 1_000_000,
    "some more columns than allowed": b",".join(b"c%d" % i for i in range(MOST_COLUMNS + 1)) + b"\n",
    "rows of another length": b"time,north\n" + b"1\n" * 1_000_000,
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_hostile_csv_file_is_a_fault_and_takes_no_time(name: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_bytes(HEADERS[name])
    begun = time.process_time()
    table = read_table(tmp_path / "run.csv")
    assert time.process_time() - begun < 2.0
    assert len(table.faults) == 1
    assert not table.columns


def test_a_parquet_file_that_stands_for_more_than_memory_holds_is_a_fault(tmp_path: Path) -> None:
    cells = MOST_CELLS + 1
    pq.write_table(pa.table({"time": np.zeros(cells, np.int8)}), tmp_path / "run.parquet", compression="zstd")
    assert (tmp_path / "run.parquet").stat().st_size < 1_000_000
    table = read_table(tmp_path / "run.parquet")
    assert [fault.message for fault in table.faults] == [
        f"says that it has {cells} rows; divide it into runs"
    ]


def test_an_mcap_file_that_stands_for_more_than_memory_holds_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "run.mcap").open("wb") as stream:
        writer = Writer(stream, chunk_size=MOST_BYTES)
        writer.start()
        channel = writer.register_channel("/run", "json", 0)
        for i in range(MOST_BYTES // 2**26 + 1):
            writer.add_message(channel, i, b" " * 2**26, i)
        writer.finish()
    assert (tmp_path / "run.mcap").stat().st_size < 1_000_000
    with pytest.raises(UserError, match="GiB unpacked; divide it into runs"):
        read_mcap(tmp_path / "run.mcap")


def test_a_parquet_file_of_too_many_columns_is_a_fault(tmp_path: Path) -> None:
    columns = {f"c{i}": np.zeros(1) for i in range(MOST_COLUMNS + 1)}
    write_table(tmp_path / "run.parquet", columns)
    assert "columns, at most" in read_table(tmp_path / "run.parquet").faults[0].message


def test_as_many_columns_as_allowed_are_read(tmp_path: Path) -> None:
    columns = {f"c{i}": np.arange(3.0) for i in range(MOST_COLUMNS)}
    for name in ("run.csv", "run.parquet"):
        write_table(tmp_path / name, columns)
        table = read_table(tmp_path / name)
        assert (len(table.columns), table.faults) == (MOST_COLUMNS, [])
