"""Every loader, and the parser of the recorder's messages, against hostile bytes."""

import json
import subprocess
import sys
import tempfile
import time
from argparse import Namespace
from pathlib import Path

from benchmarks.attack.formats import FORMATS

INPUTS, QUICK = 10_000, 200
MOST_MEMORY = 1.0
"""GB that a process may hold."""
HEAD = f"{'format':<26}{'inputs':>8}{'accepted':>10}{'refused':>9}{'findings':>10}{'slowest s':>11}{'GB':>7}"


def attack(asked: Namespace) -> int:
    """Fuzz each format in a process of its own and print the counts; how many findings there were."""
    inputs = asked.inputs or (QUICK if asked.quick else INPUTS)
    names = [name for name in FORMATS if not asked.only or name in asked.only]
    keep = Path(asked.findings) if asked.findings else Path(tempfile.mkdtemp(prefix="swamp-rl-findings-"))
    total = done = 0
    print(HEAD)
    for name in names:
        out = keep / name.replace(" ", "-").replace("/", "-")
        out.mkdir(parents=True, exist_ok=True)
        for left in out.iterdir():
            left.unlink()
        found, ended = fuzzed(name, out, inputs, asked.seed, asked.seconds)
        row = f"{name:<26}{found['inputs']:>8}{found['accepted']:>10}{found['refused']:>9}"
        print(f"{row}{len(found['findings']):>10}{found['slowest_s']:>11.2f}{found['peak_gb']:>7.2f}{ended}")
        for what, file in found["findings"].items():
            print(f"    {what} ({out / file})")
        total += len(found["findings"]) + (found["peak_gb"] > MOST_MEMORY) + bool(ended)
        done += found["inputs"]
        sys.stdout.flush()
    print(f"parsers: {done} inputs of {len(names)} formats, {total} findings")
    return total


def fuzzed(name: str, out: Path, inputs: int, seed: int, seconds: float | None) -> tuple[dict, str]:
    """The tally of one format, and how its process ended if not as it should.

    seconds: the time after which it is stopped, with the inputs that it has then met.
    """
    asked = [sys.executable, "-m", "benchmarks.attack.fuzz", name, str(out), str(inputs), str(seed)]
    begun = time.perf_counter()
    with (out / "log").open("w") as log:
        process = subprocess.Popen(asked, stdout=log, stderr=log, cwd=Path(__file__).parents[2])
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    stopped = seconds is not None and time.perf_counter() - begun >= seconds
    tally = out / "tally.json"
    nothing = {"inputs": 0, "accepted": 0, "refused": 0, "findings": {}, "slowest_s": 0.0, "peak_gb": 0.0}
    found = json.loads(tally.read_text()) if tally.is_file() else nothing
    if process.returncode == 0 or stopped:
        return found, ""
    return found, f"  ended with {process.returncode}, see {out / 'log'}"
