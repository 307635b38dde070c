"""Processes that take jobs: replaced where they were lost, and gone without a trace with their parent."""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from swamp_rl.workers.processes import ProcessPool
from tests.support.patience import until

ROOT = Path(__file__).parents[2]
KILLED = """
import os, signal
from swamp_rl.workers.processes import ProcessPool
from tests.workers.test_processes import with_a_file
with ProcessPool(with_a_file, 2) as pool:
    for number in (0, 1):
        pool.submit(number, "")
    print(pool.wait(), pool.wait())
    os.kill(os.getpid(), signal.SIGKILL)
"""


def own_number(job: str) -> str:
    """A worker's work: the number of its process."""
    return str(os.getpid())


def with_a_file(job: str) -> str:
    """A worker's work: a temporary file that it leaves."""
    return tempfile.mkstemp()[1]


@pytest.mark.timed
def test_a_process_that_was_lost_while_it_was_idle_is_replaced() -> None:
    with ProcessPool(own_number, 1) as pool:
        pool.submit(0, "")
        _, first, _ = pool.wait()
        assert first is not None
        os.kill(int(first), signal.SIGKILL)
        os.waitid(os.P_PID, int(first), os.WEXITED | os.WNOWAIT)
        pool.submit(1, "")
        number, second, error = pool.wait()
    assert (number, error) == (1, "") and second not in (None, first)


@pytest.mark.timed
def test_temporary_files_of_workers_go_where_their_parent_is_killed(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path)}
    ended = subprocess.run(
        [sys.executable, "-c", KILLED], env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    until(lambda: list(tmp_path.iterdir()) == [], "the temporary files are removed")
