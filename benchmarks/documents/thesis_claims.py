"""The tables of docs/thesis_claims.md from a folder of results.

swamp-rl run thesis_claims
python -m benchmarks.documents.thesis_claims results/thesis_claims
"""

import json
import sys
from pathlib import Path

from swamp_rl.experiments.reports.claims import hypotheses, summary

from benchmarks.markers import DOCS, write_parts


def main() -> None:
    """Write the tables from the folder named on the command line."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    results = json.loads((Path(sys.argv[1]) / "results.json").read_text(encoding="utf-8"))
    parts = {"verdicts": summary(results)} | {one["claim"]: hypotheses(one) for one in results["claims"]}
    write_parts(DOCS / "thesis_claims.md", parts)


if __name__ == "__main__":
    main()
