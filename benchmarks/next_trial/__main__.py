"""How often the designed trial makes a confounded diagnosis unique and right.

    python -m benchmarks.next_trial --cases 40 --out next_trial --into docs/criticism.md

Cases that are done stay in the folder; the table is of all of them.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.blind.arguments import add_numbers
from benchmarks.markers import DOCS, write_parts
from benchmarks.next_trial.cases import KINDS, Outcome, outcome

HEADS = (
    "first runs",
    "cases",
    "confounded",
    "unique after the trial",
    "unique and right",
    "true boat stayed in the area",
    "evidence a second over a zig-zag's, median",
    "least",
    "evidence over the best fixed manoeuvre's, median",
)


def rows_of(outcomes: Sequence[Outcome]) -> list[list[str]]:
    """A row for each kind of case, and one for all; all but the first two columns are of confounded ones."""
    rows = []
    for kind in (*(one.name for one in KINDS), "all"):
        every = [one for one in outcomes if kind in (one.kind, "all")]
        mine = [one for one in every if one.confounded]
        ratios = np.array([one.ratio for one in mine] or [np.nan])
        rows.append(
            [
                kind,
                str(len(every)),
                str(len(mine)),
                f"{sum(not one.after for one in mine)} of {len(mine)}",
                f"{sum(one.right for one in mine)} of {len(mine)}",
                f"{sum(one.kept for one in mine)} of {len(mine)}",
                f"{np.median(ratios):.1f}",
                f"{ratios.min():.1f}",
                f"{np.median([one.times_best for one in mine] or [np.nan]):.1f}",
            ]
        )
    return rows


def main() -> None:
    """Run the cases that are not done yet, as time allows, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add_numbers(parser, 40)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--into", type=Path, default=DOCS / "criticism.md")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    for number in range(given.first, given.first + given.cases):
        path = given.out / f"{number:03d}.json"
        if path.exists() or time.monotonic() - began > 60.0 * given.minutes:
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = outcome(number, Path(folder))
        path.write_text(json.dumps(vars(found)))
        print(found, flush=True)
    outcomes = [Outcome(**json.loads(path.read_text())) for path in sorted(given.out.glob("*.json"))]
    write_parts(given.into, {"next trial": table(list(HEADS), rows_of(outcomes))})


if __name__ == "__main__":
    main()
