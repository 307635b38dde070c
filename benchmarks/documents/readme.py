"""Write the measured tables of README.md and its picture from a folder of results and a benchmark's JSON.

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

ROOT = Path(__file__).resolve().parents[2]
PICTURE = "tracks.png"


def results_table(results: dict[str, Any]) -> str:
    """Success by pilot and level, then what the job took."""
    levels = results["evaluation"]["levels"]
    rows = [
        [name, *(rate(pilot["levels"][level]) for level in levels)]
        for name, pilot in results["pilots"].items()
    ]
    targets, measured = results["targets"], results["measured"]
    missed = [missed_target(target) for target in targets if not target["reached"]]
    reached = f"{len(targets) - len(missed)} of {len(targets)} targets reached"
    return (
        f"{table(['pilot', *levels], rows)}\n\n"
        f"Success in percent of {results['evaluation']['episodes']} seeded episodes, Wilson 95 % intervals; "
        f"{reached}"
        + (f" (not: {'; '.join(missed)})" if missed else "")
        + f". The job took {measured['total_seconds'] / 60:.1f} minutes and "
        f"{measured['peak_memory_gb']:.1f} GB."
    )


def missed_target(target: dict[str, Any]) -> str:
    """Which figure was not reached, and what was measured in its place."""
    measured = "nothing" if target["measured"] is None else f"{target['measured']:.3f}"
    return (
        f"{target['what']} of {target['pilot']}, {target['level']}: {measured}, needed {target['needed']:.3f}"
    )


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


def between_marks(text: str, name: str, body: str) -> str:
    """`text` with what stands between the marks of `name` replaced."""
    start, end = f"<!-- {name} -->", f"<!-- end {name} -->"
    before, rest = text.split(start, 1)
    _, after = rest.split(end, 1)
    return f"{before}{start}\n{body}\n{end}{after}"


def main(folder: Path, bench: Path) -> None:
    """Rewrite README.md in place."""
    readme = ROOT / "README.md"
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    speed = json.loads(bench.read_text(encoding="utf-8"))
    text = between_marks(readme.read_text(encoding="utf-8"), "results", results_table(results))
    readme.write_text(between_marks(text, "speed", speed_table(speed)), encoding="utf-8")
    shutil.copyfile(folder / "figures" / PICTURE, ROOT / "docs" / PICTURE)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: update_readme.py RESULTS_FOLDER BENCH_JSON")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
