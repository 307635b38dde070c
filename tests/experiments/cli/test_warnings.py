"""Warnings of libraries, about which a user of the command can do nothing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import PATIENCE

ROOT = Path(__file__).parents[3]
WARNING_WORKER = """
import warnings
import swamp_rl.experiments.cli
from swamp_rl.workers.pool import answers

def work(job):
    warnings.warn("of a library")
    return job

def verb(ended):
    assert list(answers(work, ["a"], 1)) == ["a"]

if __name__ == "__main__":
    from swamp_rl_command import main
    swamp_rl.experiments.cli.main = verb
    main()
"""


@pytest.mark.parametrize(("options", "warned"), [([], False), (["-W", "default"], True)])
def test_warnings_of_libraries_in_workers_are_printed_only_where_python_is_asked_for_them(
    tmp_path: Path, options: list[str], warned: bool
) -> None:
    (tmp_path / "warning.py").write_text(WARNING_WORKER)
    path = os.environ | {"PYTHONPATH": str(ROOT)}
    start = [sys.executable, *options, str(tmp_path / "warning.py")]
    called = subprocess.run(start, env=path, capture_output=True, text=True, timeout=PATIENCE)
    assert (called.returncode, "of a library" in called.stderr) == (0, warned), called.stderr
