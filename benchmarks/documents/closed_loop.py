"""The tables of docs/closed_loop.md from a folder of results, and from more of them for other training seeds.

    swamp-rl run closed_loop
    swamp-rl run closed_loop --set data.record.seed=1 --set pilots.reservoir.options.seed=1 \\
        --set pilots.ppo.options.seed=1 --out results/closed_loop-1
    python -m benchmarks.documents.closed_loop results/closed_loop [results/closed_loop-1 ...]
"""

import json
import sys
from pathlib import Path

from swamp_rl.experiments.evaluation.comparison import compare
from swamp_rl.experiments.reports.closed_loop import causes, differences, success
from swamp_rl.experiments.reports.comparison import improvement_table, success_table

from benchmarks.markers import DOCS, write_parts


def main() -> None:
    """Write the tables from the folders named on the command line."""
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    folders = [Path(name) for name in sys.argv[1:]]
    results = json.loads((folders[0] / "results.json").read_text(encoding="utf-8"))
    parts = {"causes": causes(results), "success": success(results), "differences": differences(results)}
    if len(folders) > 1:
        found = compare(folders)
        parts |= {"success over seeds": success_table(found), "improvement": improvement_table(found)}
    write_parts(DOCS / "closed_loop.md", parts)


if __name__ == "__main__":
    main()
