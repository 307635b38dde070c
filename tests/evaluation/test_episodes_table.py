"""Tables of episodes: what is read back is what was written, and nothing else is taken for it."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from swamp_rl.errors import UserError
from swamp_rl.evaluation import read_episodes, write_episodes
from swamp_rl.evaluation.episodes import COSTS, ELECTRIC, RETURN, Table

ROWS = 4
NUMBERS = (*COSTS, *ELECTRIC, RETURN)


def episodes() -> Table:
    """Of one pilot at one level."""
    won = np.array([True, False, True, True])
    table: Table = {"seed": np.arange(ROWS), "success": won, "outcome": np.where(won, "success", "buoy")}
    return table | {name: np.arange(ROWS) + 0.5 for name in NUMBERS}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_episodes(tmp_path / "episodes.parquet", {("a", "calm"): episodes()})
    return tmp_path / "episodes.parquet"


def refusal(path: Path, name: str, column: Any) -> str:
    """Message for the table with another column, empty where it is accepted."""
    held = pq.read_table(path)
    pq.write_table(held.set_column(held.column_names.index(name), name, column), path)
    try:
        read_episodes(path)
    except UserError as error:
        return str(error)
    finally:
        pq.write_table(held, path)
    return ""


HOSTILE = {
    "nothing": pa.nulls(ROWS),
    "text": pa.array(["zzz", "<script>", "\x1b[2J", "A" * 5000]),
    "true": pa.array([True] * ROWS),
    "true or nothing": pa.array([None, True, True, True]),
    "whole numbers": pa.array([3, 2, 1, 0]),
    "numbers": pa.array([1.5] * ROWS),
    "a number or nothing": pa.array([None, 1.5, 1.5, 1.5]),
    "half precision": pa.array(np.ones(ROWS, np.float16)),
    "lists": pa.array([[1.0]] * ROWS),
    "mappings": pa.array([{"a": 1}] * ROWS),
    "dates": pa.array([0] * ROWS, pa.timestamp("us")),
    "decimals": pa.array([1] * ROWS).cast(pa.decimal128(20)),
    "bytes": pa.array([b"\xff"] * ROWS),
}
FITS = {
    **dict.fromkeys(("pilot", "level"), ()),
    "outcome": ("text",),
    "seed": ("whole numbers",),
    "success": ("true",),
    **dict.fromkeys(NUMBERS, ("numbers", "half precision")),
}
"Of each column, what may stand there."


@pytest.mark.parametrize("name", FITS)
def test_a_column_of_another_type_is_refused_by_its_name(name: str, path: Path) -> None:
    for what, column in HOSTILE.items():
        message = refusal(path, name, column)
        assert bool(message) == (what not in FITS[name]), (what, message)
        assert not message or (
            message.startswith(f"{path}: ") and message.isprintable() and len(message) < 400
        )


@pytest.mark.parametrize("name", COSTS)
@pytest.mark.parametrize("cost", [np.nan, np.inf, -np.inf, -1.0])
def test_a_cost_that_cannot_be_is_refused(name: str, cost: float, path: Path) -> None:
    assert f"column {name}: must be finite" in refusal(path, name, pa.array([1.0, cost, 1.0, 1.0]))


@pytest.mark.parametrize("name", ELECTRIC)
def test_an_electric_cost_of_a_boat_that_did_not_move_may_be_unknown(name: str, path: Path) -> None:
    assert not refusal(path, name, pa.array([np.nan, np.inf, 1.0, 1.0]))


def test_an_episode_that_is_there_twice_is_refused(path: Path) -> None:
    assert "the episodes of a at calm have a seed twice" in refusal(path, "seed", pa.array([0, 1, 2, 0]))


def test_what_was_written_is_read_back(path: Path) -> None:
    read = read_episodes(path)["a", "calm"]
    for name, values in episodes().items():
        np.testing.assert_array_equal(read[name], values)
