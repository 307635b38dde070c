"""Write the tables of the main experiment and of speed, and the picture of the tracks, into the documents.

swamp-rl run configs/experiments/camogli.yaml
swamp-rl bench --out bench.json
python -m benchmarks.documents.readme results/camogli bench.json
"""

import json
import shutil
import sys
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.experiment import rate, table

from benchmarks.markers import DOCS, write_parts

PICTURE = "tracks.png"


def results_table(results: dict[str, Any]) -> str:
    """Success by pilot and level, percent with Wilson 95 % intervals."""
    levels = results["evaluation"]["levels"]
    rows = [
        [name, *(rate(pilot["levels"][level]) for level in levels)]
        for name, pilot in results["pilots"].items()
    ]
    return table(["pilot", *levels], rows)


def job_table(results: dict[str, Any]) -> str:
    """What the job was asked for and what it took."""
    targets, measured = results["targets"], results["measured"]
    reached = sum(target["reached"] for target in targets)
    cells = [str(results["evaluation"]["episodes"]), f"{reached} of {len(targets)}"]
    cells += [f"{measured['total_seconds'] / 60:.1f}", f"{measured['peak_memory_gb']:.1f}"]
    return table(["episodes", "targets reached", "minutes", "peak memory, GB"], [cells])


def speed_table(bench: dict[str, Any]) -> str:
    """The benchmark's ratios."""
    boats = bench["batch_boats"]
    rows = [
        ["one environment, calm, against Pendulum-v1", f"{bench['single_over_pendulum']:.1f} times as fast"],
        ["one environment, severe", f"{bench['single_severe_over_pendulum']:.1f} times as fast"],
        [
            f"{boats:,} boats in a batch, all forces on",
            f"{bench['batch_boat_steps_per_s'] / 1e6:.2f} million boat-steps/s "
            f"({bench['batch_over_pendulum']:.0f} times Pendulum-v1's steps/s)",
        ],
        ["a reservoir pilot's decision", f"{bench['reservoir_decision_us']:.0f} µs"],
        ["memory per boat in the batch", f"{bench['bytes_per_boat'] / 1024:.1f} KiB"],
    ]
    return table(["speed, measured in one run", ""], rows)


def main(folder: Path, bench: Path) -> None:
    """Rewrite in place the tables of README.md, docs/experiments.md and docs/environment.md."""
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    speed = json.loads(bench.read_text(encoding="utf-8"))
    write_parts(DOCS.parent / "README.md", {"results": results_table(results)})
    write_parts(DOCS / "experiments.md", {"job": job_table(results)})
    write_parts(DOCS / "environment.md", {"speed": speed_table(speed)})
    shutil.copyfile(folder / "figures" / PICTURE, DOCS / PICTURE)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python -m benchmarks.documents.readme RESULTS_FOLDER BENCH_JSON")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
