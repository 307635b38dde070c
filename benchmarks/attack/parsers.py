"""Every loader, and the parser of the recorder's messages, against hostile bytes."""

import subprocess
import sys
import tempfile
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path

from benchmarks.attack.counts import Count
from benchmarks.attack.formats import FORMATS, outcome
from benchmarks.attack.fuzz import Tally
from benchmarks.attack.link_formats import LINK_FORMATS

INPUTS, QUICK = 10_000, 200
MOST_MEMORY = 1.0
"""GB that a process may hold."""


def attack(asked: Namespace) -> Iterator[Count]:
    """Fuzz each format in a process of its own."""
    inputs = asked.count or (QUICK if asked.quick else INPUTS)
    keep = Path(asked.findings) if asked.findings else Path(tempfile.mkdtemp(prefix="swamp-rl-findings-"))
    for name in FORMATS:
        if asked.only is None or name in asked.only:
            out = keep / name.replace(" ", "-").replace("/", "-")
            out.mkdir(parents=True, exist_ok=True)
            for left in out.iterdir():
                left.unlink()
            if name in LINK_FORMATS:
                compile_for(name)
            yield fuzzed(name, out, inputs, asked.seed)


def compile_for(name: str) -> None:
    """Meet the good file in this process, for what a reader compiles cannot be instrumented."""
    with tempfile.TemporaryDirectory() as folder:
        path = FORMATS[name].make(Path(folder))
        outcome(FORMATS[name], path, path.read_bytes())


def fuzzed(name: str, out: Path, inputs: int, seed: int) -> Count:
    """The count of one format; unexplained is what was found, and an end otherwise than well."""
    asked = [sys.executable, "-m", "benchmarks.attack.fuzz", name, str(out), str(inputs), str(seed)]
    with (out / "log").open("w") as log:
        ended = subprocess.run(asked, stdout=log, stderr=log, cwd=Path(__file__).parents[2]).returncode
    tally = Tally.read(out, name)
    unexplained = [f"{what} ({out / file})" for what, file in tally.findings.items()]
    if tally.peak_gb > MOST_MEMORY:
        unexplained.append(f"holds {tally.peak_gb:.2f} GB")
    if ended != 0:
        unexplained.append(f"ended with {ended}, see {out / 'log'}")
    note = (
        f"{tally.accepted:,} accepted, {tally.refused:,} refused; at most {tally.slowest_s:.2f} s and "
        f"{tally.peak_gb:.2f} GB; {tally.engine}"
    )
    return Count("parsers", name, tally.inputs, unexplained, note, seed)
