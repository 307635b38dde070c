"""The repetition of timed tests counts what fails and leaves no busy process."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import psutil

from benchmarks.flicker import busy, failures, result_line

REPORT = """<testsuites><testsuite>
<testcase classname="tests.a" name="holds"/>
<testcase classname="tests.a" name="fails[1 - 2]"><failure message="x">y</failure></testcase>
<testcase classname="tests.b" name="breaks"><error message="x">y</error></testcase>
<testcase classname="tests.b" name="waits"><skipped message="x">y</skipped></testcase>
</testsuite></testsuites>"""


def test_failures_and_errors_are_counted_by_the_name_of_their_test(tmp_path: Path) -> None:
    (tmp_path / "report.xml").write_text(REPORT)
    found = failures(tmp_path / "report.xml")
    assert found == ["tests.a::fails[1 - 2]", "tests.b::breaks"]
    assert result_line(3, 8.0, "2 failed", Counter(found * 2)).endswith(
        ": `tests.a::fails[1 - 2]` 2 times, `tests.b::breaks` 2 times."
    )
    assert result_line(3, 8.0, "9 passed", Counter()).endswith("(9 passed): none failed.")


def test_busy_processes_end_with_the_block() -> None:
    before = {child.pid for child in psutil.Process().children()}
    with busy(2):
        begun = [child for child in psutil.Process().children() if child.pid not in before]
        assert len(begun) == 2
    assert not any(child.is_running() for child in begun)


def test_busy_processes_end_with_one_that_is_killed() -> None:
    text = "import time; from benchmarks.flicker import busy\nwith busy(1): print(flush=True); time.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE) as begun:
        assert begun.stdout is not None
        begun.stdout.readline()
        loops = psutil.Process(begun.pid).children()
        begun.kill()
    assert len(loops) == 1
    psutil.wait_procs(loops, timeout=60.0)
    assert not loops[0].is_running()
