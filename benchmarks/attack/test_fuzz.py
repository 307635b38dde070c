"""The fuzzer: a fork of its own for each format, guided by the reader, which is imported late."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.attack.fuzz import Tally, folder_of

FORMATS = ("path.yaml, lines", "disturbances.yaml, curves")


@pytest.mark.slow
def test_a_reader_that_is_imported_late_guides_the_inputs(tmp_path: Path) -> None:
    pytest.importorskip("atheris")
    for name in FORMATS:
        folder_of(tmp_path, name).mkdir()
    words = [sys.executable, "-m", "benchmarks.attack.fuzz", str(tmp_path), "20", "1", *FORMATS]
    ended = subprocess.run(words, capture_output=True, text=True, cwd=Path(__file__).parents[2], check=True)
    assert ended.stdout.splitlines() == [f"0 {name}" for name in FORMATS]
    assert all(Tally.read(folder_of(tmp_path, name), name).inputs == 20 for name in FORMATS)
    log = (folder_of(tmp_path, "path.yaml, lines") / "log").read_text()
    assert "Instrumenting swamp_rl.guidance.path_file" in log
    assert "swamp_rl.physics" not in log
