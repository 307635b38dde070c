"""Write docs/closed_loop.md from a folder of results, and from more of them for other training seeds.

swamp-rl run closed_loop
swamp-rl run closed_loop --set data.record.seed=1 --set pilots.reservoir.options.seed=1 \\
    --set pilots.ppo.options.seed=1 --out results/closed_loop-1
python -m benchmarks.documents.closed_loop results/closed_loop [results/closed_loop-1 ...]
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from swamp_rl.experiments.evaluation.comparison import compare
from swamp_rl.experiments.reports.closed_loop import report
from swamp_rl.experiments.reports.comparison import improvement, success

from swamp_rl.files import write_beside

ROOT = Path(__file__).resolve().parents[2]
FIRST = (
    "Written by `swamp-rl run closed_loop` and `python -m benchmarks.documents.closed_loop "
    "results/closed_loop`; the experiment is [`closed_loop.yaml`](../configs/experiments/closed_loop.yaml). "
    "Logs and lessons are runs of the scripted pilot; no person drove."
)
ONE_SEED = (
    "All this is of one training of each pilot; with folders of other training seeds, which `--set` of the "
    "seeds makes, the same command adds a comparison over the seeds."
)


def document(text: str, seeds: str) -> str:
    """A report with a line on how it came about under its title, and what other training seeds say."""
    title, _, rest = text.partition("\n\n")
    return f"{title}\n\n{FIRST}\n\n{rest.rstrip()}\n\n{seeds}\n"


def over_seeds(folders: Sequence[Path]) -> str:
    """Success over several training seeds, nominal against extended; of one folder, that it is one."""
    if len(folders) == 1:
        return ONE_SEED
    found = compare(folders)
    return "\n\n".join(part for part in (success(found), improvement(found)) if part)


def main() -> None:
    """Write the document from the folders named on the command line."""
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    folders = [Path(name) for name in sys.argv[1:]]
    results = json.loads((folders[0] / "results.json").read_text(encoding="utf-8"))
    with write_beside(ROOT / "docs" / "closed_loop.md") as part:
        part.write_text(document(report(results), over_seeds(folders)), encoding="utf-8")


if __name__ == "__main__":
    main()
