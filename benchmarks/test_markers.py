"""Only what stands between the marks of a document is written by a program."""

from pathlib import Path

import pytest

from benchmarks.markers import write_parts
from swamp_rl.errors import UserError

PAGE = "before\n<!-- a -->\nold\n<!-- end a -->\nbetween\n<!-- b -->\n<!-- end b -->\nafter\n"


def test_only_what_is_between_the_marks_changes(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    write_parts(page, {"a": "| 1 |", "b": "| 2 |"})
    marked = "before\n<!-- a -->\n| 1 |\n<!-- end a -->\nbetween\n<!-- b -->\n| 2 |\n<!-- end b -->\nafter\n"
    assert page.read_text() == marked


@pytest.mark.parametrize("name", ["c", "end a"])
def test_a_missing_mark_is_named_and_the_page_stays(tmp_path: Path, name: str) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    with pytest.raises(UserError, match=f"<!-- {name} -->"):
        write_parts(page, {"a": "| 1 |", name: "| 2 |"})
    assert page.read_text() == PAGE
