"""The command line without one of its streams, or with a coding that lacks letters."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.support.command_line import COMMAND, Call


def closed(number: int) -> None:
    os.close(number)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_verb_does_its_work_without_a_standard_stream_and_writes_nothing_of_it_into_its_files(
    folder: Path, tmp_path: Path, number: int
) -> None:
    words = ["runs", "export", str(folder), "--to", "csv"]
    whole = [COMMAND, *words, "--out"]
    subprocess.run([*whole, str(tmp_path / "with")], check=True, capture_output=True)
    done = subprocess.run([*whole, str(tmp_path / "without")], preexec_fn=lambda: closed(number))
    assert done.returncode == 0
    with_all, without = (
        {path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("with", "without")
    )
    assert without == with_all


def test_letters_that_a_terminal_lacks_are_question_marks(folder: Path, tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONIOENCODING": "ascii:strict", "COLUMNS": "20"}
    for words in (["--help"], ["runs", "show", str(folder)], ["runs", "show", "naïve—"]):
        done = subprocess.run([COMMAND, *words], env=environment, capture_output=True, cwd=tmp_path)
        assert done.returncode == (2 if words[-1].startswith("na") else 0), done.stderr
        assert done.stdout.isascii() and done.stderr.isascii()
        assert b"?" in done.stdout + done.stderr


@pytest.mark.parametrize("name", ["a\x1b[31m", "a\nswamp-rl: done", "a\u202egnp.exe", "a\x9b2J", "a\tb"])
@pytest.mark.parametrize("verb", [["runs", "check"], ["boat", "check"], ["demo"], ["run"]])
def test_a_name_that_acts_on_a_terminal_is_refused_in_one_line_that_does_not(
    call: Call, folder: Path, tmp_path: Path, verb: list[str], name: str
) -> None:
    odd = folder.rename(tmp_path / name)
    code, out, err = call(*verb, odd)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "terminal acts on; rename it" in err and err.rstrip("\n").isprintable()


def test_names_in_other_scripts_are_names(call: Call, folder: Path, tmp_path: Path) -> None:
    for name in ("Genova è qui", "שלום", "zero\u200dwidth", "no\u00a0break", "日本"):
        folder = folder.rename(tmp_path / name)
        assert call("runs", "check", folder) == (0, f"{folder}: 2 runs, 62 rows, no faults\n", "")
