"""Time and memory of a diagnosis by the length of the log.

    python -m benchmarks.blind.long_logs --out long_logs

Diagnoses runs of 10 minutes at 10 Hz (level B, two causes), with one thread and each log in a process of its
own, and writes a table of docs/criticism.md.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import DT, Case, write_case

from benchmarks.markers import DOCS, write_parts

RUNS = (1, 6, 24)
SECONDS = 600.0  # s, of each run
EFFECTS = [
    {"effect": "resistance", "scale": 1.25},
    {"effect": "thruster_gain", "thruster": "sp", "gain": 0.8},
]

# Prints wall time [s] and peak memory [kB on Linux] of a diagnosis with its self-trial.
DIAGNOSE = """
import json, resource, sys, time
from swamp_rl.criticism.diagnose import diagnose
begun = time.perf_counter()
found = diagnose(sys.argv[1], "swamp", sys.argv[2])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps([time.perf_counter() - begun, peak, [one.effect for one in found.causes]]))
"""


def measured(runs: int, out: Path) -> list[str]:
    """Row of the table for a log of so many runs."""
    folder = out / str(runs)
    case = Case("B", "pair", EFFECTS, 1.0)
    if not (folder / "data").exists():
        folder.mkdir(parents=True)
        rng = np.random.default_rng(0)
        write_case(case, rng, folder / "data", folder / "truth.json", runs=runs, seconds=SECONDS)
    threads = {f"{library}_NUM_THREADS": "1" for library in ("NUMBA", "OPENBLAS", "OMP")}
    made = subprocess.run(
        [sys.executable, "-c", DIAGNOSE, str(folder / "data"), str(folder / "out")],
        env=os.environ | threads,
        capture_output=True,
        text=True,
        check=True,
    )
    seconds, peak, causes = json.loads(made.stdout.splitlines()[-1])
    right = sorted(causes) == sorted(case.names)
    samples = round(runs * SECONDS / DT)
    minutes = runs * SECONDS / 60.0
    return [f"{minutes:.0f}", f"{samples:,}", f"{seconds:.0f}", f"{peak / 1e6:.1f}", "yes" if right else "no"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose the logs and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("long_logs"))
    asked = parser.parse_args(arguments)
    rows = []
    for runs in RUNS:
        rows.append(measured(runs, asked.out))
        print(*rows[-1], flush=True)
    heads = ["minutes of log", "samples", "wall time, s", "peak memory, GB", "causes right"]
    write_parts(DOCS / "criticism.md", {"long logs": table(heads, rows)})


if __name__ == "__main__":
    main()
