"""Write the table of measured boats into README.md, from the pages that `benchmarks.boat_fit` writes.

python -m benchmarks.documents.measured_boats
"""

import re
from pathlib import Path

from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.digits import digits

README = DOCS.parent / "README.md"
PAGES = {
    "kingfisher": "Kingfisher, 1.35 m, on a lake",
    "blueboat": "BlueBoat, 1.2 m, on a lake",
    "ferry": "a ferry with four azimuth thrusters, 5 m, in a harbour",
    "kvlcc2": "the tanker KVLCC2, 7 m, in a tank",
    "gunnerus": "the research vessel Gunnerus, 34 m, at sea",
}
SECONDS = "30"
COLUMNS = {
    "start": "start file",
    "identified with gains": "identified file",
    "constant velocity": "constant velocity",
}
"""Columns of the pages, and what they are called here."""


def boats_table() -> str:
    """Position errors by boat, of the start file, the identified one and constant velocity."""
    rows = [[f"[{words}](docs/{page}.md)", *_errors(DOCS / f"{page}.md")] for page, words in PAGES.items()]
    return table(["boat", *COLUMNS.values()], rows)


def _errors(page: Path) -> list[str]:
    """Errors [m] of COLUMNS after SECONDS, to two digits."""
    _, _, rest = page.read_text(encoding="utf-8").partition("<!-- errors -->\n")
    lines, _, _ = rest.partition("<!-- end errors -->")
    heads, _, *rows = (re.split(r" *\| *", line.strip("| ")) for line in lines.splitlines())
    (row,) = (row for row in rows if row[0] == SECONDS)
    cells = dict(zip(heads, row, strict=True))
    return [digits(float(cells[name]), 2) for name in COLUMNS]


def main() -> None:
    """Rewrite the table in place."""
    write_parts(README, {"measured boats": boats_table()})


if __name__ == "__main__":
    main()
