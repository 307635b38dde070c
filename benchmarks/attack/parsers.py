"""Every loader, and the parser of the recorder's messages, against hostile bytes."""

import subprocess
import sys
import tempfile
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path

from benchmarks.attack.counts import Count
from benchmarks.attack.formats import FORMATS
from benchmarks.attack.fuzz import Tally, folder_of

INPUTS, QUICK = 10_000, 200
MOST_MEMORY = 1.0
"""GB that a process may hold."""


def attack(asked: Namespace) -> Iterator[Count]:
    """Fuzz each format in a process of its own."""
    inputs = asked.count or (QUICK if asked.quick else INPUTS)
    keep = Path(asked.findings) if asked.findings else Path(tempfile.mkdtemp(prefix="swamp-rl-findings-"))
    names = [name for name in FORMATS if asked.only is None or name in asked.only]
    for name in names:
        out = folder_of(keep, name)
        out.mkdir(parents=True, exist_ok=True)
        for left in out.iterdir():
            left.unlink()
    words = [sys.executable, "-m", "benchmarks.attack.fuzz", str(keep), str(inputs), str(asked.seed), *names]
    root = Path(__file__).parents[2]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=root) as process:
        assert process.stdout is not None
        for line in process.stdout:
            ended, _, name = line.rstrip("\n").partition(" ")
            yield counted(name, folder_of(keep, name), int(ended), asked.seed)


def counted(name: str, out: Path, ended: int, seed: int) -> Count:
    """The count of one format; unexplained is what was found, and an end otherwise than well."""
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
