"""Every code block of README.md and of docs/ runs as it stands, in the order of its page."""

from pathlib import Path

import pytest

from tests.support import forks
from tests.support.from_scratch import written
from tests.support.pages import (
    LANGUAGES,
    ROOT,
    Block,
    assert_prints,
    blocks,
    check_options,
    commands,
    run_page,
)

pytestmark = forks.GROUP
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
NOT_RUN = {  # blocks that no test can run: servers, hours, logs of others
    "README.md": 1,
    "docs/blueboat.md": 2,
    "docs/criticism.md": 11,
    "docs/demo.md": 2,
    "docs/ferry.md": 2,
    "docs/fleet.md": 1,
    "docs/formats.md": 1,
    "docs/gunnerus.md": 2,
    "docs/identify_boat.md": 2,
    "docs/import.md": 4,
    "docs/kingfisher.md": 2,
    "docs/kvlcc2.md": 2,
    "docs/learners.md": 1,
    "docs/link.md": 3,
    "docs/own_pilot.md": 1,
    "docs/recording.md": 4,
    "docs/sea_trials.md": 1,
    "docs/sweeps.md": 1,
    "docs/trials.md": 1,
    "docs/tutorials/drive_and_learn.md": 2,
    "docs/watch.md": 1,
}


def name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def idle(block: Block) -> bool:
    """It is marked, or has no language, which is as good as marked."""
    return bool(block.reason) or not block.language


def test_no_more_blocks_are_left_out_than_are_counted_here() -> None:
    counts = {name(page): sum(map(idle, blocks(page))) for page in PAGES}
    assert {page: count for page, count in counts.items() if count} == NOT_RUN


def test_every_language_is_one_that_is_run() -> None:
    unknown = {
        f"{name(page)}, line {block.line}: {block.language}"
        for page in PAGES
        for block in blocks(page)
        if block.language and block.language not in LANGUAGES
    }
    assert unknown == set()


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page)], ids=name)
def test_the_blocks_of_a_page_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_page(page, tmp_path) == sum(not idle(block) for block in blocks(page))


def test_the_log_of_the_tutorial_can_be_of_a_boat_whose_thrusters_do_not_turn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = ROOT / "docs" / "tutorials" / "diagnose_a_log.md"
    (block,) = [one for one in blocks(page) if one.language == "python"]
    boat = written(tmp_path, "twin")
    monkeypatch.chdir(tmp_path)
    exec(block.text.replace('load_boat("swamp")', f"load_boat({str(boat)!r})"), {})
    assert (tmp_path / "log.csv").read_text().startswith("time,north,east,heading,surge,sway,yaw_rate,thr")


def test_a_command_that_fails_or_prints_something_else_is_seen(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    for text, message in (
        ("$ false", "false"),
        ("$ echo one\ntwo", "expected"),
        ("$ echo 1.5\n1.4...", "expected"),
    ):
        page.write_text(f"```console\n{text}\n```\n")
        with pytest.raises(AssertionError, match=message):
            run_page(page, tmp_path)
    page.write_text("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n")
    with pytest.raises(AssertionError, match="expected"):
        run_page(page, tmp_path)


@pytest.mark.parametrize(
    "command", ["swamp-rl recrd --out runs", "swamp-rl record --ouut runs", "swamp-rl trial plan"]
)
def test_a_wrong_option_is_seen_in_a_block_that_is_not_run(command: str) -> None:
    with pytest.raises(AssertionError, match="page"):
        check_options(Block("console", f"$ {command}\n", 1, "waits", False), "page")


def test_commands_are_distinguished_from_what_they_print() -> None:
    assert list(commands("$ a \\\n  b\nsaid\n$ c\n")) == [("a \\\n  b", "said"), ("c", "")]
    assert_prints("a ... c", "a b\nc", "dots stand for anything")
