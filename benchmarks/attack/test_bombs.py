"""Files of few bytes that stand for many, have no end, or act beyond their folder: refused."""

import io
import sqlite3
import struct
import zipfile
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from swamp_rl.experiments.sweep.store import TABLES, Trial, opened

from benchmarks.attack.formats import FORMATS, with_checksum
from swamp_rl.errors import UserError
from swamp_rl.ordinary import MOST_JSON
from swamp_rl.runs.mcap_files import boat_of_mcap
from swamp_rl.runs.resample import MOST_CELLS as MOST_RESAMPLED
from swamp_rl.runs.resample import resampled
from swamp_rl.runs.table import MOST_CELLS, MOST_COLUMNS
from swamp_rl.seal import BLANK
from swamp_rl.tensors_file import LONGEST, tensors_in

PLAN = {"seed": 0}


def refused(name: str, path: Path, *message: str) -> None:
    """Its reader says so in words that hold these."""
    with pytest.raises(UserError) as error:
        FORMATS[name].read(path)
    assert all(word in str(error.value) for word in message), error.value


def naming(journal: Path, victim: Path, database: Path) -> None:
    """A journal that SQLite rolls back, and that names a file which it then deletes."""
    page = struct.unpack(">H", database.read_bytes()[16:18])[0]
    magic, name = bytes.fromhex("d9d505f920a163d7"), str(victim).encode()
    head = magic + struct.pack(">IIIII", 0, 7, database.stat().st_size // page, 512, page)
    content = struct.pack(">I", 2**30 // page + 1) + name
    content += struct.pack(">II", len(name), sum(byte if byte < 128 else byte - 256 for byte in name) % 2**32)
    journal.write_bytes(head.ljust(512, b"\0") + content + magic)


def test_a_sweeps_journal_cannot_have_a_file_elsewhere_deleted(tmp_path: Path) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    victim, journal = tmp_path / "victim", path.with_name(f"{path.name}-journal")
    victim.write_bytes(b"precious")
    naming(journal, victim, path)
    with pytest.raises(UserError, match="names a file elsewhere"), opened(path.parent, PLAN):
        pass
    assert victim.read_bytes() == b"precious"
    sqlite3.connect(path).execute("SELECT * FROM trials").fetchall()
    assert not victim.exists(), "SQLite itself no longer does it: the refusal can go"


@pytest.mark.parametrize("suffix", ["", "-journal", "-wal", "-shm"])
def test_a_sweep_that_is_a_link_is_refused_and_what_it_leads_to_stays(suffix: str, tmp_path: Path) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    link, other = path.with_name(path.name + suffix), tmp_path / "other"
    sqlite3.connect(other).execute("CREATE TABLE mine (x)")
    before = other.read_bytes()
    link.unlink(missing_ok=True)
    link.symlink_to(other)
    with pytest.raises(UserError, match="is a link"), opened(path.parent, PLAN):
        pass
    assert other.read_bytes() == before


ENDLESS = (
    "WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r) SELECT n AS plan FROM r WHERE n < 0"
)


@pytest.mark.parametrize(
    "statements",
    [
        [TABLES["trials"], f"CREATE VIEW plan AS {ENDLESS}"],
        [*TABLES.values(), "CREATE TRIGGER t AFTER INSERT ON trials BEGIN DELETE FROM trials; END"],
        [TABLES["plan"], "CREATE TABLE trials (number INTEGER PRIMARY KEY, trial AS (zeroblob(16000000)))"],
        [TABLES["plan"], "CREATE TABLE trials (number INTEGER PRIMARY KEY, trial TEXT DEFAULT 'x')"],
        [TABLES["plan"]],
    ],
)
def test_a_sweeps_file_with_other_tables_than_ours_is_not_asked(
    statements: list[str], tmp_path: Path
) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    path.unlink()
    with sqlite3.connect(path) as made:
        for statement in statements:
            made.execute(statement)
    refused("trials.sqlite", path, "holds something else than")


def tree(children: list[int], before: bytes, size: int) -> bytes:
    """A page of SQLite that leads to others (https://sqlite.org/fileformat2.html#b_tree_pages)."""
    cells = [struct.pack(">IB", child, 1) for child in children[:-1]]
    starts = [size - 5 * (i + 1) for i in range(len(cells))]
    head = struct.pack(">BHHHBI", 5, 0, len(cells), starts[-1], 0, children[-1])
    page = before + head + struct.pack(f">{len(cells)}H", *starts)
    return page.ljust(starts[-1], b"\0") + b"".join(reversed(cells))


def leaf(page: bytes, cells: Sequence[int]) -> bytes:
    """A page with these of another page's rows, by their places there."""
    head = struct.pack(f">BHHHB{len(cells)}H", 13, 0, len(cells), min(cells), 0, *cells)
    return head.ljust(min(cells), b"\0") + page[min(cells) :]


def with_rows_without_end(path: Path, table: str) -> None:
    """The rows of a table repeated 30^8 times, by pages that lead to the same page; of an index its row of
    the schema."""
    with closing(sqlite3.connect(path)) as made:
        (root,) = made.execute("SELECT rootpage FROM sqlite_schema WHERE name = ?", (table,)).fetchone()
    data = path.read_bytes()
    size = int.from_bytes(data[16:18], "big")
    pages = [data[i : i + size] for i in range(0, len(data), size)]
    before, first = b"", []
    if table.startswith("sqlite"):  # page 1, whose head comes after that of the file: all rows, then the last
        cells = struct.unpack(">2H", pages[0][108:112])
        pages += [leaf(pages[0], cells), leaf(pages[0], cells[1:])]
        root, before, first = 1, data[:100], [len(pages) - 1]
    else:
        pages.append(pages[root - 1])
    for _ in range(7):
        pages.append(tree([len(pages)] * 30, b"", size))
    pages[root - 1] = tree([*first, *[len(pages)] * 30], before, size)
    data = b"".join(pages)
    counted = struct.pack(">I", len(pages))
    path.write_bytes(data[:28] + counted + data[32:92] + data[24:28] + data[96:])


@pytest.mark.parametrize("name", ["trials.sqlite", "ros2.db3"])
def test_a_table_that_repeats_its_pages_without_end_is_refused(name: str, tmp_path: Path) -> None:
    path = FORMATS[name].make(tmp_path)
    with_rows_without_end(path, {"trials.sqlite": "trials", "ros2.db3": "messages"}[name])
    refused(name, path, "is damaged", "out of order")


def test_a_list_of_tables_that_repeats_its_pages_without_end_is_refused(tmp_path: Path) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    path.unlink()
    with closing(sqlite3.connect(path)) as made:
        made.execute("CREATE TABLE trials (trial TEXT UNIQUE)")
    with_rows_without_end(path, "sqlite_autoindex_trials_1")
    refused("trials.sqlite", path, "has tables without end")


def test_a_bag_whose_messages_are_a_view_without_end_is_refused(tmp_path: Path) -> None:
    path = FORMATS["ros2.db3"].make(tmp_path)
    with closing(sqlite3.connect(path)) as made:
        made.execute("DROP TABLE messages")
        made.execute(f"CREATE VIEW messages AS {ENDLESS}")
        made.commit()
    refused("ros2.db3", path, "something else than tables")


def test_a_sweep_made_here_is_taken_up_and_a_row_too_long_refused(tmp_path: Path) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    with opened(path.parent, PLAN) as store:
        store.add(Trial(9, {"a": 1.0}, 0.5, {"mean": 1.0}, None, 1, 0.1))
        assert 9 in store.trials()
    with sqlite3.connect(path) as made:
        made.execute("INSERT INTO trials VALUES (99, zeroblob(20000000))")
    refused("trials.sqlite", path, "too big")


def with_column(path: Path, name: str, values: Any) -> None:
    """The Parquet file with one more column."""
    columns = {**{one: pq.read_table(path)[one] for one in pq.read_table(path).column_names}, name: values}
    pq.write_table(pa.table(columns), path, compression="zstd", store_schema=False)


def shared(rows: int, size: int = 2**20) -> pa.Array:
    """One text that so many rows share."""
    return pa.DictionaryArray.from_arrays(pa.array(np.zeros(rows, np.int32)), pa.array(["x" * size]))


@pytest.mark.parametrize(("name", "column"), [("run.parquet", "note"), ("episodes.parquet", "pilot")])
def test_a_text_that_all_rows_share_is_there_once(name: str, column: str, tmp_path: Path) -> None:
    path = FORMATS[name].make(tmp_path)
    rows = 300
    whole = pq.read_table(path).take(pa.array(np.zeros(rows, np.int64)))
    pq.write_table(whole, path)
    with_column(path, column, shared(rows))
    before, pool = pa.default_memory_pool(), pa.proxy_memory_pool(pa.default_memory_pool())
    pa.set_memory_pool(pool)
    try:
        refused(name, path, "xxx")
    finally:
        pa.set_memory_pool(before)
    assert 0 < pool.max_memory() < 30 * 2**20, "a copy for each row"


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_a_csv_file_of_more_cells_than_fit_is_refused_before_it_is_parsed(end: bytes, tmp_path: Path) -> None:
    path = FORMATS["run.csv"].make(tmp_path)
    names = b",".join(b"c%d" % i for i in range(MOST_COLUMNS - 1))
    row = b"," * (MOST_COLUMNS - 2) + end
    rows = MOST_CELLS // (MOST_COLUMNS - 1)
    path.write_bytes(names + end + row * rows)
    pool, before = pa.proxy_memory_pool(pa.default_memory_pool()), pa.default_memory_pool()
    pa.set_memory_pool(pool)
    try:
        refused("run.csv", path, f"at most {MOST_CELLS} cells", "divide")
    finally:
        pa.set_memory_pool(before)
    assert (pool.max_memory() or 0) < 2**20


def test_a_column_of_lists_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = FORMATS["run.parquet"].make(tmp_path)
    rows = pq.read_metadata(path).num_rows
    with_column(path, "note", pa.array([[0.0] * 9] * rows))
    refused("run.parquet", path, "note", "list")


def test_packed_arrays_and_arrays_over_each_other_are_refused(tmp_path: Path) -> None:
    path = FORMATS["arrays.npz"].make(tmp_path)
    kept = io.BytesIO()
    np.save(kept, np.zeros(10**6))
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", kept.getvalue())
        archive.comment = BLANK.encode()
    path.write_bytes(with_checksum(packed.getvalue()))
    refused("arrays.npz", path, "packed or lie over each other")


@pytest.mark.parametrize("compression", ["lz4", "zstd"])
def test_a_chunk_of_mcap_that_unpacks_to_more_than_it_says_is_refused(
    compression: str, tmp_path: Path
) -> None:
    module = pytest.importorskip({"lz4": "lz4.frame", "zstd": "zstandard"}[compression])
    path = FORMATS["run.mcap"].make(tmp_path)
    data = path.read_bytes()
    packed = module.compress(bytes(2**22))
    chunk = struct.pack("<QQQI", 0, 1, 1000, 0)
    chunk += (
        struct.pack("<I", len(compression)) + compression.encode() + struct.pack("<Q", len(packed)) + packed
    )
    head = 17 + struct.unpack("<Q", data[9:17])[0]
    end = b"\x0f" + struct.pack("<QI", 4, 0) + b"\x02" + struct.pack("<Q", 20) + bytes(20)
    record = b"\x06" + struct.pack("<Q", len(chunk)) + chunk
    path.write_bytes(data[:head] + record + end + b"\x89MCAP0\r\n")
    refused("run.mcap", path, "is larger than it declares")
    with pytest.raises(UserError, match="is larger than it declares"):
        boat_of_mcap(path)


def test_a_header_of_tensors_without_end_is_not_parsed() -> None:
    def load(data: bytes) -> dict[str, Any]:
        raise AssertionError("it is parsed")

    for size in (LONGEST + 1, 2**63):
        with pytest.raises(ValueError, match="at most"):
            tensors_in(struct.pack("<Q", size) + b"{}", load)


@pytest.mark.parametrize("name", ["diagnosis.json", "pilot.json"])
def test_a_json_text_that_would_fill_the_memory_is_refused_unread(name: str, tmp_path: Path) -> None:
    path = FORMATS[name].make(tmp_path)
    path.write_bytes(b"[" + b"[]," * (MOST_JSON // 3) + b"[]]")
    refused(name, path, "is larger than 16 MiB")


def test_a_graph_that_cannot_be_computed_is_reported_in_one_line(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    path = FORMATS["pilot.onnx"].make(tmp_path)
    model = onnx.load(path)
    size = onnx.numpy_helper.from_array(np.array([2**50], np.int64), "size")
    zero = onnx.helper.make_tensor("v", onnx.TensorProto.DOUBLE, [1], [0.0])
    model.graph.initializer.append(size)
    model.graph.node.append(onnx.helper.make_node("ConstantOfShape", ["size"], ["huge"], value=zero))
    model.graph.output.append(onnx.helper.make_tensor_value_info("huge", onnx.TensorProto.DOUBLE, [None]))
    path.write_bytes(with_checksum(model.SerializeToString()))
    pilot = FORMATS["pilot.onnx"].read(path)
    pilot.reset(1)
    with pytest.raises(UserError, match="cannot be computed") as error:
        pilot.act(np.zeros((1, len(pilot.senses))), np.zeros((1, 2)))
    assert str(error.value).isprintable()


def test_a_wide_run_is_not_resampled_into_more_cells_than_a_narrow_one() -> None:
    time = np.linspace(0.0, 1e6, 20_001)
    wide = {"time": time} | {f"c{i}": time for i in range(99)}
    with pytest.raises(UserError, match=f"at most {MOST_RESAMPLED // 100}"):
        resampled(wide, 1.0)
    assert len(resampled({"time": time}, 1.0)["time"]) == 10**6 + 1
