"""Write docs/thesis_claims.md from a folder of results.

swamp-rl run thesis_claims
python -m benchmarks.documents.thesis_claims results/thesis_claims
"""

import json
import sys
from pathlib import Path

from swamp_rl.experiments.reports.claims import report

from benchmarks.documents.closed_loop import ROOT
from swamp_rl.files import write_beside

FIRST = (
    "Written by `swamp-rl run thesis_claims` and `python -m benchmarks.documents.thesis_claims "
    "results/thesis_claims`; hypotheses and bounds stand in "
    "[`thesis_claims.yaml`](../configs/experiments/thesis_claims.yaml)."
)


def document(text: str) -> str:
    """A report with a line on how it came about under its title."""
    title, _, rest = text.partition("\n\n")
    return f"{title}\n\n{FIRST}\n\n{rest}"


def main() -> None:
    """Write the document from the folder named on the command line."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    results = json.loads((Path(sys.argv[1]) / "results.json").read_text(encoding="utf-8"))
    with write_beside(ROOT / "docs" / "thesis_claims.md") as part:
        part.write_text(document(report(results)), encoding="utf-8")


if __name__ == "__main__":
    main()
