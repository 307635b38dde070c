"""The leaderboard page: complete, self-contained, and with every name as text."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from playwright.sync_api import sync_playwright
from swamp_rl.experiments.reports.leaderboard import gather, page

from swamp_rl.errors import UserError
from tests.support.result_folders import folder_of


def test_each_pilot_has_a_row_at_each_level_best_first(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"ppo": np.arange(10) < 4, "reservoir": np.ones(10)})
    text = page(gather(tmp_path))
    rows = re.findall(r'<tr><td class="" data-key="(\w+)">', text)
    assert rows == ["reservoir", "ppo"]
    assert ">40.0<" in text and ">100.0<" in text


def test_training_seeds_share_a_row(tmp_path: Path) -> None:
    for seed in range(3):
        folder_of(tmp_path / f"s{seed}", {"ppo": np.arange(10) < 4 + seed}, seed)
    (row,) = gather(tmp_path).rows
    assert (row.cells[2][0], row.cells[4][0]) == ("50.0", "3")


def test_only_what_was_learned_from_runs_has_their_source(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "a", {"ppo": np.ones(5), "reservoir": np.ones(5)})
    file = folder / "config" / "experiment.yaml"
    file.write_text(yaml.safe_dump({**yaml.safe_load(file.read_text()), "data": {"folder": "pier"}}))
    learned = {"ppo": "20,000 decisions in the simulator", "reservoir": "all successful runs"}
    pilots = {name: {"learned_from": text} for name, text in learned.items()}
    (folder / "results.json").write_text(json.dumps({"data": {"source": "human"}, "pilots": pilots}))
    found = {row.cells[0][0]: row.cells[10][0] for row in gather(tmp_path).rows}
    assert found == {"ppo": learned["ppo"], "reservoir": "human: all successful runs"}


def test_a_name_that_is_markup_stays_text(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "a", {"ppo": np.ones(5)})
    file = folder / "config" / "experiment.yaml"
    evil = '<script>alert("1")</script>'
    file.write_text(yaml.safe_dump({**yaml.safe_load(file.read_text()), "name": evil, "boat": evil}))
    text = page(gather(tmp_path))
    assert evil not in text and text.count("<script>") == 1
    assert "&lt;script&gt;alert(&quot;1&quot;)" in text


def test_nothing_is_loaded_from_elsewhere(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"ppo": np.ones(5)})
    assert not re.search(r"(src|href|url)\s*[=(]|https?:|@import", page(gather(tmp_path)))


def test_other_courses_are_ranked_apart(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"ppo": np.ones(5)})
    folder_of(tmp_path / "b", {"ppo": np.ones(5)}, course="elsewhere")
    assert page(gather(tmp_path)).count("<h2>") == 2


def test_a_result_that_cannot_be_read_is_reported_on_the_page(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"ppo": np.ones(5)})
    broken = folder_of(tmp_path / "b", {"ppo": np.ones(5)})
    (broken / "config" / "experiment.yaml").unlink()
    board = gather(tmp_path)
    assert len(board.left_out) == 1 and "Left out" in page(board)
    (tmp_path / "a" / "episodes.parquet").write_bytes(b"")
    with pytest.raises(UserError, match="no result in it can be read"):
        gather(tmp_path)


def test_a_heading_sorts_by_number_and_the_other_way_when_clicked_again(
    tmp_path: Path, chromium: str
) -> None:
    rates = {"ppo": np.arange(12) < 9, "reservoir": np.arange(12) < 12}
    folder_of(tmp_path / "a", rates)
    (tmp_path / "page.html").write_text(page(gather(tmp_path)), encoding="utf-8")
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        shown = browser.new_page()
        faults: list[str] = []
        shown.on("pageerror", lambda error: faults.append(str(error)))
        shown.goto((tmp_path / "page.html").as_uri())
        read = "[...document.querySelectorAll('td:nth-child(3)')].map(cell => cell.textContent)"
        orders = []
        for _ in range(2):
            shown.get_by_role("button", name="success").click()
            orders.append(shown.evaluate(read))
        browser.close()
    assert (orders, faults) == ([["100.0", "75.0"], ["75.0", "100.0"]], [])
