"""`swamp-rl compare` on the command line: what it writes, what it says, what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.cli.app import app
from typer.testing import CliRunner

from swamp_rl.errors import UserError
from tests.support.result_folders import folder_of


def test_two_folders_become_a_table_and_two_files(tmp_path: Path) -> None:
    one = folder_of(tmp_path / "one", {"reservoir": np.arange(50) < 45})
    two = folder_of(tmp_path / "two", {"ppo": np.arange(50) < 20})
    out = tmp_path / "out"
    run = CliRunner().invoke(app, ["compare", str(one), str(two), "--out", str(out)])
    assert run.exit_code == 0, run.output
    assert "90.0 (78.6–95.7)" in run.output  # Wilson, 45 of 50
    found = json.loads((out / "compare.json").read_text())
    assert [pilot["name"] for pilot in found["pilots"]] == ["reservoir", "ppo"]
    text = (out / "compare.md").read_text()
    assert "| reservoir − ppo, calm | success [%] | +50.0" in text
    assert "Probability of improvement" not in text  # there is one of each


def test_only_the_named_pilots_are_compared_and_corrected_for(tmp_path: Path) -> None:
    wins = {"reservoir": 43, "ppo": 40, "clone-1": 30, "clone-2": 20}
    folders = [
        folder_of(tmp_path / name, {one: np.arange(50) < n + more for one, n in wins.items()}, ridge=more)
        for name, more in (("one", 0), ("two", 7), ("three", 3))
    ]
    out = tmp_path / "out"
    asked = ["compare", *map(str, folders), "--out", str(out)]
    run = CliRunner().invoke(app, asked)
    assert "66 paired differences: see" in run.output and "p (Holm)" not in run.output
    before = json.loads((out / "compare.json").read_text())
    run = CliRunner().invoke(app, [*asked, "--only", "reservoir"])
    assert "reservoir (one) − reservoir" in run.output and "ppo" not in run.output
    found = json.loads((out / "compare.json").read_text())
    pair = ("reservoir (one)", "reservoir (two)", "success")
    was, now = (
        next(row for row in one["differences"] if (row["a"], row["b"], row["quantity"]) == pair)
        for one in (before, found)
    )
    assert now["p"] == was["p"] and now["p_corrected"] < was["p_corrected"] / 4.0
    run = CliRunner().invoke(app, [*asked, "--only", "reservor"])
    assert str(run.exception).startswith("no pilot 'reservor' in the results; did you mean 'reservoir'?")
    run = CliRunner().invoke(app, ["compare", "--leaderboard", str(tmp_path), "--only", "reservoir"])
    assert "a leaderboard has them all" in str(run.exception)


def test_each_interval_and_p_value_says_whether_it_is_corrected(tmp_path: Path) -> None:
    folders = [
        folder_of(tmp_path / name, {name: np.arange(50) < n}) for name, n in (("ppo", 45), ("reservoir", 20))
    ]
    out = tmp_path / "out"
    run = CliRunner().invoke(app, ["compare", *map(str, folders), "--out", str(out)])
    for text in (run.output, (out / "compare.md").read_text()):
        assert "mean (95 %, uncorrected)" in text and "p (Holm)" in text
    page = (out / "compare.md").read_text()
    assert page.count("corrected by Holm over all") == page.count("Tango's score interval") == 1
    assert page.index("Tango's") < page.index("## Costs, paired differences")


def test_a_folder_of_results_becomes_a_page(tmp_path: Path) -> None:
    folder_of(tmp_path / "results" / "one", {"reservoir": np.ones(9)})
    page = tmp_path / "page.html"
    asked = ["compare", "--leaderboard", str(tmp_path / "results"), "--out", str(page)]
    run = CliRunner().invoke(app, asked)
    assert run.exit_code == 0, run.output
    assert "1 row of 1 result" in run.output
    assert page.read_text().startswith("<!doctype html>")


@pytest.mark.parametrize("asked", [[], ["somewhere", "--leaderboard", "elsewhere"]])
def test_results_or_a_leaderboard_is_asked_for_but_not_both(asked: list[str]) -> None:
    run = CliRunner().invoke(app, ["compare", *asked])
    assert isinstance(run.exception, UserError)
    assert "not both" in str(run.exception)


def test_an_earlier_comparison_is_replaced_only_if_nothing_in_it_was_changed(tmp_path: Path) -> None:
    one = folder_of(tmp_path / "one", {"reservoir": np.arange(50) < 45})
    out = tmp_path / "out"
    asked = ["compare", str(one), "--out", str(out)]
    for _ in range(2):
        assert CliRunner().invoke(app, asked).exit_code == 0
    (out / "compare.md").write_text("my notes")
    run = CliRunner().invoke(app, asked)
    assert isinstance(run.exception, UserError)
    assert "is not replaced, as compare.md in it came or changed" in str(run.exception)
    assert (out / "compare.md").read_text() == "my notes"


def test_a_page_is_replaced_only_by_one_of_the_same_folder(tmp_path: Path) -> None:
    folder_of(tmp_path / "results" / "one", {"reservoir": np.ones(9)})
    folder_of(tmp_path / "others" / "one", {"ppo": np.ones(9)})
    page = tmp_path / "page.html"
    for _ in range(2):
        asked = ["compare", "--leaderboard", str(tmp_path / "results"), "--out", str(page)]
        assert CliRunner().invoke(app, asked).exit_code == 0
    run = CliRunner().invoke(app, ["compare", "--leaderboard", str(tmp_path / "others"), "--out", str(page)])
    assert isinstance(run.exception, UserError)
    assert "already exists" in str(run.exception)
