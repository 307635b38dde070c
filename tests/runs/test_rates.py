"""Rows of any distance in time, and sample rates that no log has."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from swamp_rl.runs import check_dataset, inspect_dataset
from swamp_rl.runs.table import write_table
from tests.support.runs import circling

ROWS = len(circling()["time"])


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for a run without a `dataset.yaml`."""
    return tmp_path_factory.mktemp("alone")


@given(st.floats(min_value=0.0, exclude_min=True, max_value=1e300))
@example(5e-324)
@example(1e-310)
@example(1e300)
def test_rows_any_time_apart_have_a_rate_or_one_fault(alone: Path, step: float) -> None:
    columns = circling()
    columns["time"] = step * np.arange(ROWS)
    write_table(alone / "run.parquet", columns)
    found = inspect_dataset(alone, "swamp").faults
    faults = [str(fault) for fault in found if fault.column == "time"]
    assert len(faults) <= 1
    if not 1e-10 < step < 1e10:
        assert "s apart; give the times in s" in faults[0]


@pytest.mark.parametrize("rate", ["5e-324", "1e-310", "1e308"])
def test_a_sample_rate_that_no_log_has_is_refused(folder: Path, rate: str) -> None:
    path = folder / "dataset.yaml"
    lines = path.read_text(encoding="utf-8").splitlines()
    lines = [f"sample_rate: {rate}" if line.startswith("sample_rate:") else line for line in lines]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    (fault,) = check_dataset(folder)
    assert "sample_rate" in str(fault)
