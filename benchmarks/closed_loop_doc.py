"""Write docs/closed_loop.md from a folder of results.

swamp-rl run closed_loop
python -m benchmarks.closed_loop_doc results/closed_loop
"""

import json
import sys
from pathlib import Path

from experiments.closed_loop_report import report
from swamp_rl.files import write_beside

ROOT = Path(__file__).resolve().parents[1]
FIRST = (
    "Written by `swamp-rl run closed_loop` and `python -m benchmarks.closed_loop_doc results/closed_loop`; "
    "the experiment is [`closed_loop.yaml`](../configs/experiments/closed_loop.yaml). Logs and lessons "
    "are runs of the scripted pilot; no person drove."
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
    with write_beside(ROOT / "docs" / "closed_loop.md") as part:
        part.write_text(document(report(results)), encoding="utf-8")


if __name__ == "__main__":
    main()
