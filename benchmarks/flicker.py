"""Tests marked `timed`, many times beside busy processes: which of them ever fails.

python -m benchmarks.flicker --times 20 --load 8               # the line of CONTRIBUTING.md
python -m benchmarks.flicker --times 3 --load 8 tests/link     # some of them, to the screen

Rounds run beside each other, `--at-once` many: each is load to the others. So many processes compute
without end beside them that there are `--load` in all; what the machine had on average is written as well.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

from benchmarks.markers import write_parts

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "CONTRIBUTING.md"
LOOP = "import os, sys\nwhile os.getppid() == int(sys.argv[1]): pass"


@contextmanager
def busy(count: int) -> Iterator[None]:
    """So many processes that compute until the block, or this process, has ended."""
    loops = [subprocess.Popen([sys.executable, "-S", "-c", LOOP, str(os.getpid())]) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def failures(report: Path) -> list[str]:
    """The tests that failed, from pytest's report in XML."""
    cases = ElementTree.parse(report).iter("testcase")
    return [
        f"{case.get('classname')}::{case.get('name')}"
        for case in cases
        if any(case.find(kind) is not None for kind in ("failure", "error"))
    ]


def run_once(chosen: Sequence[str]) -> tuple[list[str], str]:
    """The failures of one round of the tests, and pytest's last line; AssertionError where none ran."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        options = ["-m", "timed", "-p", "no:cacheprovider", f"--junitxml={report}"]
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *chosen], cwd=ROOT, capture_output=True, text=True
        )
        assert done.returncode in (0, 1), done.stdout + done.stderr
        found = failures(report)
        if found:
            print(done.stdout, file=sys.stderr)
        return found, done.stdout.strip().splitlines()[-1]


def result_line(times: int, load: float, tests: str, failed: Counter[str]) -> str:
    """What is written into the page."""
    begun = f"{times} rounds of these tests at a mean load of {load:.1f} on {os.cpu_count()} cores ({tests})"
    if not failed:
        return f"{begun}: none failed."
    named = ", ".join(f"`{test}` {count} times" for test, count in failed.most_common())
    return f"{begun}: {named}."


def main() -> None:
    """Run the rounds; a line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--times", type=int, default=20, help="rounds")
    parser.add_argument("--load", type=int, default=8, help="busy processes, the rounds themselves included")
    parser.add_argument("--at-once", type=int, default=4, help="rounds beside each other")
    parser.add_argument("chosen", nargs="*", help="files or folders of tests; all where none is given")
    asked = parser.parse_args()
    failed: Counter[str] = Counter()
    loads: list[float] = []
    last = ""
    with busy(max(0, asked.load - asked.at_once)), ThreadPoolExecutor(asked.at_once) as pool:
        rounds = [pool.submit(run_once, asked.chosen) for _ in range(asked.times)]
        for number, done in enumerate(as_completed(rounds), 1):
            new, last = done.result()
            failed.update(new)
            loads.append(os.getloadavg()[1])
            print(f"round {number}, load {loads[-1]:.1f}: {last}", *new, sep="\n  ", flush=True)
    line = result_line(asked.times, sum(loads) / len(loads), last.split(" in ")[0], failed)
    print(line)
    if not asked.chosen:
        write_parts(PAGE, {"flicker": line})


if __name__ == "__main__":
    main()
