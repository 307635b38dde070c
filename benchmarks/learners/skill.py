"""Write the table of drivers' skill in docs/learners.md from a folder of results of that experiment.

swamp-rl run configs/experiments/skill.yaml
python -m benchmarks.learners.skill results/skill
"""

import json
import sys
from pathlib import Path

from benchmarks.documents.readme import results_table
from benchmarks.markers import DOCS, write_parts


def main() -> None:
    """Write the table."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    results = json.loads((Path(sys.argv[1]) / "results.json").read_text(encoding="utf-8"))
    write_parts(DOCS / "learners.md", {"skill": results_table(results)})


if __name__ == "__main__":
    main()
