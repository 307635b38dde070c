"""Faults seeded in runs of the scripted driver and in runs under wandering commands: found, and false.

python -m benchmarks.doctor                     # the table of docs/import.md
python -m benchmarks.doctor --datasets 2 --screen
"""

import argparse
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np

from benchmarks.doctor.seeds import (
    BOATS,
    NOISES,
    SEEDS,
    Seed,
    measured,
    smooth_runs,
    sound_runs,
    steered_runs,
    twin_boat,
)
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.doctor.examine import examine
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

SMOOTH_RUNS, STEERED_RUNS = 4, 3
PERIODIC = "steered by sines"


def datasets(count: int, folder: Path) -> dict[str, tuple[Boat, list[list[Run]]]]:
    """Noise-free datasets by source, with their boat. Nothing is seeded in periodic ones: half a period is
    equivalent to a fault.
    """
    found = {}
    for name, (_, size, _) in BOATS.items():
        runs = sound_runs(name, count * size, 1, folder)
        found[name] = (load_boat(name), [runs[i * size : (i + 1) * size] for i in range(count)])
    twin = twin_boat(folder)
    for boat in (load_boat("swamp"), twin):
        runs = smooth_runs(boat, count * SMOOTH_RUNS, 1)
        parts = [runs[i * SMOOTH_RUNS : (i + 1) * SMOOTH_RUNS] for i in range(count)]
        found[f"{boat.name}, commands that wander"] = (boat, parts)
    found[PERIODIC] = (twin, [steered_runs(twin, STEERED_RUNS, number) for number in range(count)])
    return found


def faults(runs: list[Run], boat: Boat) -> list[Finding]:
    """The findings that are faults."""
    return [finding for finding in examine(runs, boat) if finding.level == "fault"]


def judged(count: int, draws: int, folder: Path) -> tuple[dict[str, Counter[str]], Counter[str], list[str]]:
    """Found and tried by fault and noise; false and tried by noise; the false findings.

    draws: of the noise of each sound dataset; faults are seeded in the first.
    """
    found: dict[str, Counter[str]] = defaultdict(Counter)
    false: Counter[str] = Counter()
    lines = []
    for source, (boat, parts) in datasets(count, folder).items():
        for noise in NOISES:
            rng = np.random.default_rng(1)
            for part in parts:
                clean = [[measured(run, noise, rng) for run in part] for _ in range(draws)]
                for runs in clean:
                    wrong = faults(runs, boat)
                    false[f"{noise} tried"] += 1
                    false[noise] += bool(wrong)
                    lines += [f"{source}, {noise}: {finding}" for finding in wrong]
                for seed in SEEDS if source != PERIODIC else ():
                    if seed.differs(clean[0]):
                        found[seed.name][f"{noise} tried"] += 1
                        found[seed.name][noise] += _is_found(seed, clean[0], boat, rng)
    return found, false, lines


def _is_found(seed: Seed, clean: list[Run], boat: Boat, rng: np.random.Generator) -> bool:
    changed = [Run(run.name, seed.change(dict(run.columns), rng)) for run in clean]
    return any(finding.code in seed.codes for finding in faults(changed, boat))


def table(found: dict[str, Counter[str]], false: Counter[str]) -> str:
    """Markdown."""
    lines = [f"| seeded fault | {' | '.join(f'found, {noise}' for noise in NOISES)} |", "|:--|--:|--:|"]
    total: Counter[str] = Counter()
    for name, counts in found.items():
        cells = [f"{counts[n]} of {counts[f'{n} tried']}" if counts[f"{n} tried"] else "–" for n in NOISES]
        lines.append(f"| {name} | {' | '.join(cells)} |")
        total.update(counts)
    cells = [f"{total[n] / total[f'{n} tried']:.1%} of {total[f'{n} tried']}" for n in NOISES]
    lines.append(f"| **all** | {' | '.join(cells)} |")
    cells = [f"{false[n]} of {false[f'{n} tried']}" for n in NOISES]
    lines.append(f"| **sound datasets with a fault found** | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--datasets", type=int, default=3, help="of each source")
    parser.add_argument("--draws", type=int, default=8, help="of the noise of each sound dataset")
    parser.add_argument("--screen", action="store_true", help="print, and write no document")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found, false, result = judged(asked.datasets, asked.draws, Path(folder))
    print("\n".join([table(found, false), *result]))
    if not asked.screen:
        write_parts(DOCS / "import.md", {"doctor": f"\n{table(found, false)}\n"})


if __name__ == "__main__":
    main()
