"""Refused system calls, kills and power cuts, in small: `python -m benchmarks.attack` does thousands."""

import json
import os
import resource
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.command_line import COMMAND

pytestmark = pytest.mark.timed

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def compiler() -> None:
    """Of the library that has calls fail: without it these tests are skipped, but fail where CI is set."""
    if not any(shutil.which(name) for name in ("cc", "gcc", "clang")):
        message = (
            "no C compiler is installed; refused system calls are not tested (Debian: apt-get install gcc)"
        )
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)


@pytest.mark.usefixtures("compiler")
@pytest.mark.parametrize(
    ("part", "words", "least"),
    [
        ("kills", ["--count", "28"], 28),
        ("power", ["--count", "20"], 20),
        ("faults", ["--only", "record", "--count", "1"], 20),
        ("faults", ["--only", "import", "--count", "1"], 20),
    ],
)
def test_nothing_about_the_attack_is_unexplained(
    part: str, words: list[str], least: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", ["benchmarks.attack", part, *words, "--keep", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("benchmarks.attack", run_name="__main__")
    (kept,) = [json.loads(path.read_text()) for path in tmp_path.iterdir()]
    assert (kept["unexplained"], ended.value.code) == ([], 0)
    assert kept["tried"] >= least


@pytest.mark.parametrize("to", ["minari", "lerobot", "mcap", "csv", "parquet"])
def test_an_export_onto_a_full_disk_is_one_line_and_leaves_nothing(
    folder: Path, tmp_path: Path, to: str
) -> None:
    def little_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))

    words = ["runs", "export", str(folder), "--to", to, "--out", str(tmp_path / "out")]
    # No caches of compiled code are written meanwhile.
    env = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([COMMAND, *words], preexec_fn=little_room, capture_output=True, text=True, env=env)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and "File too large" in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == [folder.name]
