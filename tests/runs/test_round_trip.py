"""What is written is what is read, to the bit, in both formats."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from swamp_rl.errors import UserError
from swamp_rl.runs import (
    Run,
    RunMeta,
    append_run,
    create_dataset,
    inspect_dataset,
    read_dataset,
    read_run,
    write_run,
)
from swamp_rl.runs.table import read_table, write_table
from swamp_rl.runs.text_header import unquoted
from tests.support.runs import THRUSTERS, circling, described

FINITE = st.floats(allow_nan=False, allow_infinity=False)
NAMES = st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs")), min_size=1).filter(
    lambda name: name == unquoted(name) != ""  # as text loses the spaces and quotation marks around a name
)


@given(
    # One column alone with a semicolon in its name is taken for a table separated by them.
    st.dictionaries(NAMES, st.integers(0, 2**32), min_size=1, max_size=4).filter(
        lambda names: len(names) > 1 or not set(";\t") & set(next(iter(names)))
    ),
    st.integers(1, 20),
    st.sampled_from(["csv", "parquet"]),
    st.data(),
)
def test_any_finite_table_comes_back_equal_to_the_bit(
    tmp_path_factory: pytest.TempPathFactory, names: dict[str, int], rows: int, kind: str, data: st.DataObject
) -> None:
    columns = {name: data.draw(hnp.arrays(np.float64, rows, elements=FINITE)) for name in names}
    path = tmp_path_factory.mktemp("table") / f"table.{kind}"
    write_table(path, columns)
    table = read_table(path)
    assert table.faults == []
    assert list(table.columns) == list(columns)
    for name, values in columns.items():
        assert table.columns[name].tobytes() == values.tobytes()


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_dataset_comes_back_with_its_runs_and_all_that_was_said_of_them(tmp_path: Path, kind: str) -> None:
    meta = RunMeta.model_validate(
        {
            "seed": 2**63,
            "initial_state": {"north": 0.1, "azimuth_bs": -1e-05},
            "disturbances": [{"effect": "current", "north": 0.1 + 0.2}],
            "outcome": "success",
            "weather": {"sky": "grey", "nobody": None},
        }
    )
    create_dataset(tmp_path / "set", described(notes="of a calm day", licence="CC-BY-4.0"))
    append_run(tmp_path / "set", Run("first", circling(), meta), kind)
    dataset = read_dataset(tmp_path / "set")
    (run,) = dataset.runs
    assert dataset.meta.notes == "of a calm day"
    assert run.name == "first"
    assert run.meta.model_dump(exclude={"file", "rows"}) == meta.model_dump(exclude={"file", "rows"})
    for name, values in circling().items():
        assert run.columns[name].tobytes() == values.tobytes()


def test_a_csv_and_a_parquet_file_of_one_run_hold_the_same_bits(tmp_path: Path) -> None:
    for kind in ("csv", "parquet"):
        write_run(tmp_path / f"run.{kind}", Run("run", circling()))
    one, other = (read_run(tmp_path / f"run.{kind}").columns for kind in ("csv", "parquet"))
    assert {name: values.tobytes() for name, values in one.items()} == {
        name: values.tobytes() for name, values in other.items()
    }


def test_an_unknown_column_is_kept_and_reported_once(folder: Path) -> None:
    columns = circling() | {"salinity": np.full(31, 38.0)}
    append_run(folder, Run("three", columns))
    append_run(folder, Run("four", columns))
    found = inspect_dataset(folder)
    assert found.faults == []
    message = "three.parquet and 1 other: column salinity is not in the run format; kept as it is"
    assert found.notes == [message]
    assert (found.runs[2].columns["salinity"] == 38.0).all()


def test_unknown_columns_of_the_same_files_are_reported_in_one_line(folder: Path) -> None:
    append_run(folder, Run("three", circling() | {"salinity": np.full(31, 38.0), "roll": np.zeros(31)}))
    append_run(folder, Run("four", circling() | {"pitch": np.zeros(31)}))
    assert inspect_dataset(folder).notes == [
        "three.parquet: columns salinity, roll are not in the run format; kept as they are",
        "four.parquet: column pitch is not in the run format; kept as it is",
    ]


def test_a_learner_knows_which_runs_succeeded(folder: Path) -> None:
    assert [run.name for run in read_dataset(folder).successful] == ["one"]


def test_a_run_knows_what_its_dataset_says_of_it(folder: Path) -> None:
    run = read_run(folder / "two.parquet")
    assert (run.meta.seed, run.meta.outcome) == (2, "buoy")


def test_views_of_a_run_agree_with_its_columns() -> None:
    run = Run("run", circling(seconds=3.0))
    assert run.duration == 3.0
    assert run.pose.shape == (31, 3)
    assert run.joypad.shape == (31, 2)
    # The chords of a circle are a little shorter than its arcs, here by (0.025 rad)^2 / 24.
    assert run.path_length == pytest.approx(2.0 * 0.25 * 3.0, rel=1e-4)
    commands = run.commands(THRUSTERS)
    assert commands.shape == (31, 8)
    assert (commands[:, 2] == run.columns["azimuth_ss"]).all()
    assert (commands[:, 7] == run.columns["throttle_sp"]).all()


def test_a_fixed_thruster_needs_no_azimuth_column() -> None:
    columns = circling()
    del columns["azimuth_bp"]
    with pytest.raises(UserError, match="azimuth_bp is missing"):
        Run("run", columns).commands(THRUSTERS)
    assert (Run("run", columns).commands(THRUSTERS, fixed=["bp"])[:, 1] == 0.0).all()
