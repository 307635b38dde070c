"""What a job prints can be read and copied in a narrow terminal."""

from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.reports.terminal import print_results

LEVELS = ["calm", "standard", "severe"]


def test_the_pilots_of_camogli_have_one_line_each_in_80_columns(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    rates = {level: {"success_rate": 1.0, "wilson_95": [0.912, 1.0]} for level in LEVELS}
    print_results(
        {
            "name": "camogli",
            "evaluation": {"levels": LEVELS, "episodes": 40},
            "pilots": {"reservoir-alone": {"levels": rates}},
            "targets": [],
            "measured": {"total_seconds": 3.0, "peak_memory_gb": 0.4},
        },
        Path("results"),
    )
    (row,) = [line.split() for line in capsys.readouterr().out.splitlines() if "reservoir" in line]
    assert row == ["reservoir-alone", *(["100.0", "(91.2–100.0)"] * 3)]


def test_no_name_of_a_pilot_is_cut_off_and_no_path_is_broken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    rates = {level: {"success_rate": 1.0, "wilson_95": [0.758, 1.0]} for level in LEVELS}
    results: dict[str, Any] = {
        "name": "smoke",
        "evaluation": {"levels": LEVELS, "episodes": 12},
        "pilots": {"reservoir-alone-of-tuesday": {"levels": rates}},
        "targets": [],
        "measured": {"total_seconds": 47.0, "peak_memory_gb": 0.8},
    }
    folder = Path("/home/somebody/a long way down/to the results of the boat of 15 metres/and its pilots")
    print_results(results, folder)
    message = capsys.readouterr().out
    assert f"{folder}/report.md\n" in message and "…" not in message
    first_column = "".join(line[:18].strip() for line in message.splitlines())
    assert "reservoir-alone-of-tuesday" in first_column
