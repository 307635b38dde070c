"""A long verb shows what it does, from its first second."""

import logging
import re
from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.cli.progress import progress

from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import Diagnosis
from tests.support.command_line import Call


def test_a_diagnosis_says_what_it_reads_before_anything_else(call: Call) -> None:
    _, out, error = call("diagnose", "nowhere", "--boat", "swamp", "--out", "a")
    assert out.splitlines()[:2] == ["diagnosing nowhere against boat swamp", "    0 s  reading nowhere"]
    assert len(error.splitlines()) == 1


def test_stages_are_printed_with_the_time_and_single_fits_only_on_a_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with progress(LOG):
        LOG.info("hypotheses of %d effects [sic]", 2)
        LOG.debug("segments of 5 s: wind")
    LOG.info("afterwards")
    assert capsys.readouterr().out == "    0 s  hypotheses of 2 effects [sic]\n"
    assert LOG.level == logging.NOTSET and not LOG.handlers


def test_the_seconds_of_a_diagnosis_are_those_of_the_command(
    call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    empty = ("causes", "indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    meta: dict[str, Any] = {name: [] for name in empty} | {"separating_trial": None, "noise": {}}
    found = Diagnosis(verdict="nothing_wrong", **meta, adequacy={}, elapsed_s=9999.0)
    monkeypatch.setattr("swamp_rl.criticism.diagnose.diagnose", lambda *given: found)
    code, message, _ = call("diagnose", folder, "--out", "out")
    assert code == 0 and re.search(r"report\.html \(\d{1,2} s\)\n$", message)
