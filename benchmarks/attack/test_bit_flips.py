"""A flipped bit of an artefact is reported when it is read: never other numbers in silence."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.sweep.store import opened

from benchmarks.attack.formats import FORMATS
from benchmarks.attack.samples import circle, meta, run
from swamp_rl.errors import UserError
from swamp_rl.replacement import WRITTEN
from swamp_rl.runs import append_run, create_dataset, read_dataset
from swamp_rl.runs.export_dataset import export_runs
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.mcap_files import read_mcap
from swamp_rl.seal import BLANK, refuse_changed, sealed
from swamp_rl.sums import SUMS, changed

FLIPS = 60


def flips(data: bytes, seed: int, count: int = FLIPS) -> list[bytes]:
    """Copies of the bytes with one bit flipped in each."""
    chance, found = random.Random(seed), []
    for _ in range(count):
        at = chance.randrange(8 * len(data))
        flipped = bytearray(data)
        flipped[at // 8] ^= 1 << at % 8
        found.append(bytes(flipped))
    return found


@pytest.mark.parametrize("name", ["pilot.onnx", "arrays.npz", "weights", "pilot.json", "checkpoint"])
def test_every_flipped_bit_of_a_sealed_artefact_is_refused(name: str, tmp_path: Path) -> None:
    path = FORMATS[name].make(tmp_path)
    good = path.read_bytes()
    FORMATS[name].read(path)
    for flipped in flips(good, seed=1):
        path.write_bytes(flipped)
        with pytest.raises(UserError):
            FORMATS[name].read(path)


def test_a_flipped_bit_of_a_sweep_is_refused_or_loses_a_trial_and_never_changes_one(tmp_path: Path) -> None:
    path = FORMATS["trials.sqlite"].make(tmp_path)
    good = path.read_bytes()

    def read() -> dict[int, Any]:
        with opened(path.parent, {"seed": 0}) as store:
            return store.trials()

    whole, refused = read(), 0
    at = good.index(b'"summary"')  # where trials are, few of whose bits are padding
    for flipped in [
        *flips(good, seed=2),
        *(good[:at] + part + good[at + 9 :] for part in flips(good[at : at + 9], 3)),
    ]:
        path.write_bytes(flipped)
        try:
            assert read().items() <= whole.items()
        except UserError:
            refused += 1
    assert refused >= FLIPS


def same(one: Any, other: Any) -> bool:
    return one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in one)


def test_a_flipped_bit_of_an_mcap_file_is_refused_or_changes_nothing(tmp_path: Path) -> None:
    path = FORMATS["run.mcap"].make(tmp_path)
    good, whole, refused = path.read_bytes(), read_mcap(path), 0
    for flipped in flips(good, seed=3, count=200):
        path.write_bytes(flipped)
        try:
            found = read_mcap(path)
        except UserError:
            refused += 1
            continue
        assert same(found.table.columns, whole.table.columns)
        assert (found.meta, found.dataset) == (whole.meta, whole.dataset)
    assert refused > 50


@pytest.mark.parametrize("to", ["csv", "parquet", "mcap", "lerobot", "minari"])
def test_a_flipped_bit_of_any_exported_file_is_reported(to: Any, tmp_path: Path) -> None:
    create_dataset(tmp_path / "runs", meta())
    append_run(tmp_path / "runs", run())
    out = tmp_path / "out"
    export_runs(tmp_path / "runs", to, out)
    readers: dict[str, Callable[[], Any]] = {
        "csv": lambda: read_dataset(out),
        "parquet": lambda: read_dataset(out),
        "mcap": lambda: import_runs([out], "mcap", tmp_path / "imported"),
    }
    assert changed(out) == []
    files = [path for path in sorted(out.rglob("*")) if path.is_file() and path.name not in (SUMS, WRITTEN)]
    for file in files:
        good = file.read_bytes()
        for flipped in flips(good, seed=4, count=3):
            file.write_bytes(flipped)
            assert [file.relative_to(out).as_posix() in line for line in changed(out)] == [True]
            if to in readers:
                with pytest.raises(UserError):
                    readers[to]()
        file.write_bytes(good)
    assert changed(out) == []
    if to in readers:
        readers[to]()


def test_a_run_added_to_an_exported_dataset_leaves_no_stale_checksums(tmp_path: Path) -> None:
    create_dataset(tmp_path / "runs", meta())
    append_run(tmp_path / "runs", run())
    export_runs(tmp_path / "runs", "csv", tmp_path / "out")
    append_run(tmp_path / "out", type(run())("two", circle(), run().meta))
    assert len(read_dataset(tmp_path / "out").runs) == 2


@pytest.mark.parametrize(
    "line", ["nonsense", f"{'0' * 64}  ../runs/dataset.yaml", f"{'0' * 64}  missing.csv"]
)
def test_a_line_of_checksums_that_is_none_is_reported(line: str, tmp_path: Path) -> None:
    (tmp_path / SUMS).write_text(line + "\n")
    assert len(changed(tmp_path)) == 1


def test_a_seal_is_over_all_bytes_but_itself_and_there_once() -> None:
    whole = sealed(b"before " + BLANK.encode() + b" after")
    refuse_changed("here", whole, "write it again")
    for flipped in flips(whole, seed=5, count=8 * len(whole)):
        with pytest.raises(UserError, match="here: "):
            refuse_changed("here", flipped, "write it again")
    for data in (b"no room", BLANK.encode() * 2):
        with pytest.raises(ValueError, match="must be there once"):
            sealed(data)
