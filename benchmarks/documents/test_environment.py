"""The environment's page is in step with the code."""

import re
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.task import TaskArguments

from benchmarks.documents.environment import PAGE, RandomPilot, declared, returns_table
from benchmarks.markers import write_parts


@pytest.mark.parametrize("part", sorted(declared()))
def test_the_page_has_the_tables_of_what_is_declared(part: str) -> None:
    match = re.search(rf"<!-- {part} -->\n(.*?)\n<!-- end {part} -->", PAGE.read_text(), re.DOTALL)
    assert match is not None
    assert match[1] == declared()[part], "python -m benchmarks.documents.environment --terms"


def test_the_page_names_every_argument() -> None:
    page = PAGE.read_text()
    assert [name for name in TaskArguments.__annotations__ if f"| `{name}` |" not in page] == []


def test_the_table_of_returns_has_an_interval_for_each_pilot_and_level(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("<!-- returns -->\n<!-- end returns -->\n")
    write_parts(page, {"returns": returns_table(episodes=4)})
    rows = re.findall(
        r"^\| ([a-z -]+), (\w+) \| (-?[\d.]+) \((-?[\d.]+) to (-?[\d.]+)\)", page.read_text(), re.M
    )
    assert len(rows) == 9
    assert all(float(low) <= float(mean) <= float(high) for *_, mean, low, high in rows)


def test_random_actions_stay_in_the_action_space() -> None:
    levers = RandomPilot(0).act(np.zeros((1000, 1)))
    assert levers.min(axis=0) == pytest.approx([0.0, -1.0], abs=0.01)
    assert levers.max(axis=0) == pytest.approx([1.0, 1.0], abs=0.01)
